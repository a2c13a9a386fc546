// Nodes of the image scheme that hide their misses: each holds several packets, its contexts, and works on
// one of them at a time; on a miss it switches to the next one that is ready. Lines may be prefetched.
//
// Switching on a miss, after Weber, Gupta, Exploring the benefits of multiple hardware contexts in a
// multiprocessor architecture, ISCA 1989, and Agarwal, Performance tradeoffs in multithreaded processors,
// IEEE TPDS 3(5), 1992 (APRIL).
#pragma once

#include <array>
#include <limits>
#include <utility>

#include "processors/cost/step_time.h"
#include "processors/node/packet_nodes.h"
#include "processors/walk/guarded_caches.h"
#include "processors/walk/log_walker.h"
#include "processors/walk/waiting_time.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h. The members are described in node_array.h. The cursor of the context
/// that the node works on is in cursors_, those of its other contexts in contexts_.
template <class Caches>
class ContextNodes final : public PacketNodes<ContextNodes<Caches>, Cursor> {
  using Base = PacketNodes<ContextNodes<Caches>, Cursor>;
  friend Base;
  using Base::begin_pixel;
  using Base::cursors_;
  using Base::end_;
  using Base::engine_;
  using Base::has_room;
  using Base::host_;
  using Base::input_;
  using Base::interconnect_of;
  using Base::place_of;
  using Base::port_of;
  using Base::ports_;
  using Base::post;
  using Base::spend;
  using Base::statistics_;
  using Base::watch;
  using Base::watch_misses;
  using Base::write_pixel;

 public:
  ContextNodes(const ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : Base(input, engine, host),
        walker_(input, GuardedCaches<Caches>(input, std::move(caches))),
        switch_(input.config.clock.cycles(input.config.switch_cycles)),
        cores_(input.config.all_nodes()),
        contexts_(std::size_t{input.config.all_nodes()} * input.config.contexts),
        services_(std::size_t{input.config.all_nodes()} * ports_) {
    for (Core& core : cores_) {
      core.live = input.config.contexts;
    }
  }

  // A request by context c of node n has component c * nodes + n, so all first contexts come first.
  void start(std::uint64_t seed) override {
    const std::uint32_t nodes = input_.config.all_nodes();
    for (const std::uint32_t node : Base::first_order(seed)) {
      for (std::uint32_t context = 0; context < input_.config.contexts; ++context) {
        post(EventClass::dispatch, 0, context * nodes + node);
      }
    }
  }

  void handle(const sim::Event& event) override {
    const std::uint32_t component = event.component();
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        if (event.sequence() == wake_sequence) {
          wake(component);
        } else {
          run(component);
        }
        break;
      case EventClass::dispatch:
        dispatch(component);
        break;
      case EventClass::reply: {
        const std::uint32_t node = component / ports_;
        interconnect_of(node).reply(port_of(node) + component % ports_);
        break;
      }
      case EventClass::memory: {
        const std::uint32_t node = component / ports_;
        interconnect_of(node).proceed(port_of(node) + component % ports_, event.sequence());
        break;
      }
      case EventClass::read:
        read(component);
        break;
      case EventClass::write:
        if (has_room(component)) {
          write_pixel(component);
        }
        break;
    }
  }

  void finish() override {
    for (NodeStatistics& node : statistics_) {
      add_counted_time(walker_.ticks(), node.steps, node.references.all_hits(), node.time);
      node.time[static_cast<std::size_t>(Activity::idle)] = end_ - node.finish;
    }
    Base::watch_idle();
  }

  SecondLevelResult second_level() const override { return walker_.behind().second_level().result(); }

  ContextResult context_result() const override { return {walker_.caches().counts()}; }

  std::size_t bytes_per_node() const override {
    return Base::common_bytes() + sizeof(Core) + input_.config.contexts * sizeof(Context) +
           ports_ * sizeof(memory::Service);
  }

 private:
  static constexpr std::uint32_t wake_sequence = 1;

  static bool for_pixel(const Cursor& /*cursor*/) { return true; }

  // What a context waits for: none: it is ready; miss: its own miss; line: a line that another transaction
  // brings; host: the start of its packet; done: its last packet is done.
  enum class Wait : std::uint8_t { none, miss, line, host, done };

  struct Context {
    Cursor cursor;             // of this context, while the node works on another
    sim::Ticks ready = never;  // when it is ready to continue; never while that is not known
    std::uint64_t packet = 0;  // its number at the host
    std::uint32_t slot = 0;    // the transaction that it waits for
    Wait wait = Wait::none;
  };

  struct Core {
    sim::Ticks since = 0;     // when it began to wait
    sim::Ticks wake = never;  // when the wait is known to end
    std::uint32_t active = 0;
    std::uint32_t live = 0;  // contexts that may still get a packet
    bool waiting = true;     // no context is ready
    bool fresh = true;       // no context has been worked on yet
    bool due = false;        // the walk stopped with Stop::due
  };

  Context& context_of(std::uint32_t node, std::uint32_t context) {
    return contexts_[std::size_t{node} * input_.config.contexts + context];
  }
  memory::Service& service_of(std::uint32_t node, std::uint32_t slot) {
    return services_[std::size_t{node} * ports_ + slot];
  }
  Cursor& cursor_of(std::uint32_t node, std::uint32_t context) {
    return context == cores_[node].active ? cursors_[node] : context_of(node, context).cursor;
  }

  // A context asks for a packet: the active one, or any at the beginning of the frame.
  void dispatch(std::uint32_t component) {
    const std::uint32_t nodes = input_.config.all_nodes();
    const std::uint32_t node = component % nodes;
    Core& core = cores_[node];
    const std::uint32_t number = component < nodes ? core.active : component / nodes;
    Context& context = context_of(node, number);
    const sim::Ticks now = engine_.now();
    const std::optional<Grant> grant = host_.next(node, now);
    if (!grant) {
      context.wait = Wait::done;
      if (--core.live == 0) {
        statistics_[node].finish = now;
        end_ = std::max(end_, now);
        return;
      }
    } else {
      ++statistics_[node].packets;
      Cursor& cursor = cursor_of(node, number);
      cursor.packet = input_.packets[grant->packet];
      cursor.y = cursor.packet.y0;
      cursor.x = cursor.packet.x0;
      begin_pixel(cursor);
      context.wait = Wait::host;
      context.ready = grant->start;
      context.packet = grant->packet;
    }
    if (core.waiting) {
      expect(node, context.ready);
    } else if (number == core.active) {
      stall(node);
    }
  }

  // Works on the active context until it needs something shared.
  void run(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    NodeStatistics& statistics = statistics_[node];
    const sim::Ticks from = cursor.time;
    const Stop stop = input_.step_by_step ? walker_.template advance<false>(node, cursor, statistics)
                                          : walker_.template advance<true>(node, cursor, statistics);
    if (stop == Stop::end) {
      walker_.finish_pixel(node, cursor, statistics);
    }
    watch(node, NodeState::working, from);
    cores_[node].due = stop == Stop::due;
    switch (stop) {
      case Stop::hit:
        post(EventClass::step, cursor.time, node);
        break;
      case Stop::miss:
      case Stop::due:
        post(EventClass::read, cursor.time, node);
        break;
      case Stop::end:
        post(EventClass::write, cursor.time, node);
        break;
    }
  }

  void read(std::uint32_t node) {
    Core& core = cores_[node];
    Cursor& cursor = cursors_[node];
    Context& context = context_of(node, core.active);
    const auto cache = walker_.caches().view(node);
    if (!core.due) {
      miss(node, cursor, context);
      stall(node);
      return;
    }
    if (cursor.branch != Cursor::no_branch && cursor.at >= cursor.end) {
      walker_.caches().targets().each_child_line(cursor.branch, [&](std::uint32_t line) {
        prefetch(node, memory::RecordKind::node, line);
        return true;
      });
      cursor.branch = Cursor::no_branch;
      run(node);
      return;
    }
    const std::uint32_t slot = cache.awaits(cursor.kind, line_of(cursor), engine_.now());
    if (slot == LinesUnderWay::none) {
      run(node);
      return;
    }
    ++(slot < input_.config.contexts ? cache.counts().joined : cache.counts().late);
    context.wait = Wait::line;
    context.slot = slot;
    context.ready = service_of(node, slot).done;
    stall(node);
  }

  std::uint32_t line_of(const Cursor& cursor) const {
    return static_cast<std::uint32_t>(walker_.missed_address(cursor) / input_.config.cache.cache.line);
  }

  // Reads the reference that missed from memory; a miss may also prefetch the next line.
  void miss(std::uint32_t node, const Cursor& cursor, Context& context) {
    const std::uint32_t slot = cores_[node].active;
    context.wait = Wait::miss;
    context.slot = slot;
    context.ready = never;
    if constexpr (Caches::present) {
      walker_.caches().view(node).begin(cursor.kind, line_of(cursor), slot, engine_.now());
    }
    issue(node, slot, walker_.missed_address(cursor), walker_.missed_bytes(cursor));
    if constexpr (Caches::present) {
      if (input_.config.prefetch.next_line) {
        if (const auto next = walker_.caches().targets().next(cursor.kind, line_of(cursor))) {
          prefetch(node, cursor.kind, *next);
        }
      }
    }
  }

  void prefetch(std::uint32_t node, memory::RecordKind kind, std::uint32_t line) {
    const auto cache = walker_.caches().view(node);
    if (cache.holds(kind, line)) {
      return;
    }
    std::uint32_t slot = input_.config.contexts;
    while (slot < ports_ && service_of(node, slot).done > engine_.now()) {
      ++slot;
    }
    if (slot == ports_) {
      ++cache.counts().dropped;
      return;
    }
    cache.prefetch(kind, line, slot, engine_.now());
    const std::uint32_t bytes = input_.config.cache.cache.line;
    issue(node, slot, memory::Address{line} * bytes, bytes);
  }

  void issue(std::uint32_t node, std::uint32_t slot, memory::Address address, std::uint32_t bytes) {
    service_of(node, slot).done = never;
    interconnect_of(node).read({port_of(node) + slot, address, bytes});
  }

  // `port` is numbered through all nodes.
  void read_done(std::uint32_t port, const memory::Service& service) {
    const std::uint32_t node = port / ports_;
    const std::uint32_t slot = port % ports_;
    service_of(node, slot) = service;
    end_ = std::max(end_, service.done);  // a prefetched line may arrive after all nodes are done
    if constexpr (Caches::present) {
      walker_.caches().view(node).arrives(slot, service.done);
    }
    for (std::uint32_t number = 0; number < input_.config.contexts; ++number) {
      Context& context = context_of(node, number);
      if ((context.wait == Wait::miss || context.wait == Wait::line) && context.slot == slot &&
          context.ready == never) {
        context.ready = service.done;
        if (cores_[node].waiting) {
          expect(node, service.done);
        }
      }
    }
  }

  // Lets a waiting node continue at `time`.
  void expect(std::uint32_t node, sim::Ticks time) {
    Core& core = cores_[node];
    if (time < core.wake) {
      core.wake = time;
      engine_.post(sim::Event::make(time, static_cast<std::uint8_t>(EventClass::step), node, wake_sequence));
    }
  }

  // The active context has asked for something, or its last packet is done. The context continues at once
  // when what it asked for takes no time.
  void stall(std::uint32_t node) {
    const sim::Ticks now = engine_.now();
    Core& core = cores_[node];
    const bool goes_on = context_of(node, core.active).ready <= now;
    const std::uint32_t next = goes_on ? core.active : next_ready(node, now);
    if (next != none) {
      take_up(node, next, now);
      return;
    }
    core.waiting = true;
    core.since = now;
    core.wake = never;
    for (std::uint32_t number = 0; number < input_.config.contexts; ++number) {
      expect(node, context_of(node, number).ready);
    }
  }

  // Ends a node's wait, unless an event for an earlier end was posted after this one.
  void wake(std::uint32_t node) {
    Core& core = cores_[node];
    const sim::Ticks now = engine_.now();
    if (!core.waiting || core.wake != now) {
      return;
    }
    const std::uint32_t next = next_ready(node, now);
    const Context& context = context_of(node, next);
    const sim::Ticks since = core.since;
    if (context.wait == Wait::host) {
      spend(node, Activity::dispatch_wait, now - since);
      if (input_.observer != nullptr && now != since) {
        input_.observer->spent(node, NodeState::dispatch_wait, since, now, {});
      }
    } else {
      const memory::Service waited = last_part(service_of(node, context.slot), now - since);
      spend(node, waited);
      if (input_.observer != nullptr) {
        resume_packet(node, next);
        const Cursor& cursor = cursor_of(node, next);
        spent_reading(*input_.observer, node, waited, since, {cursor.x, cursor.y});
      }
    }
    core.waiting = false;
    take_up(node, next, now);
  }

  // The first context that is ready, from the one after the active context on; `none` if no context is ready.
  std::uint32_t next_ready(std::uint32_t node, sim::Ticks now) {
    const std::uint32_t contexts = input_.config.contexts;
    const std::uint32_t last = cores_[node].active;
    // At first no context is active, so the search begins with the first.
    for (std::uint32_t step = cores_[node].fresh ? 0 : 1; step <= contexts; ++step) {
      const std::uint32_t number = last + step < contexts ? last + step : last + step - contexts;
      if (context_of(node, number).ready <= now) {
        return number;
      }
    }
    return none;
  }

  void take_up(std::uint32_t node, std::uint32_t number, sim::Ticks now) {
    Core& core = cores_[node];
    Context& context = context_of(node, number);
    Cursor& cursor = cursors_[node];
    const bool other = number != core.active;
    if (other) {
      watch_misses(node, place_of(node));
      const std::uint32_t writes = cursor.writes;  // the contexts share the write buffer
      context_of(node, core.active).cursor = cursor;
      cursor = context.cursor;
      cursor.writes = writes;
      core.active = number;
    }
    if (context.wait != Wait::host) {
      resume_packet(node, number);
    }
    cursor.time = now;
    if (other && !core.fresh) {
      cursor.time = sim::add_ticks(now, switch_);
      spend(node, Activity::switching, switch_);
      ++walker_.caches().view(node).counts().switches;
      watch(node, NodeState::working, now);
    }
    core.fresh = false;
    context.ready = never;
    const Wait waited = std::exchange(context.wait, Wait::none);
    if (waited == Wait::miss) {
      walker_.pass(cursor);
    } else if (waited == Wait::host && input_.observer != nullptr) {
      input_.observer->began_packet(node, context.packet, cursor.time);
    }
    run(node);
  }

  void resume_packet(std::uint32_t node, std::uint32_t number) {
    if (input_.observer != nullptr) {
      input_.observer->resumed_packet(node, context_of(node, number).packet);
    }
  }

  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  LogWalker<GuardedCaches<Caches>> walker_;
  sim::Ticks switch_;
  sim::LargeVector<Core> cores_;
  sim::LargeVector<Context> contexts_;  // node by node
  // The last transaction of each port, node by node; done is `never` while its end is not known.
  sim::LargeVector<memory::Service> services_;
};

}  // namespace marti::processors
