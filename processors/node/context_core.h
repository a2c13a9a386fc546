// Nodes that hold several packets, their contexts, and work on one of them at a time: which context a node
// works on, what it waits for, and how its waits are divided. What a context does is left to the derived
// class.
//
// Switching on a miss, after Weber, Gupta, Exploring the benefits of multiple hardware contexts in a
// multiprocessor architecture, ISCA 1989, and Agarwal, Performance tradeoffs in multithreaded processors,
// IEEE TPDS 3(5), 1992 (APRIL).
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "processors/node/packet_nodes.h"
#include "processors/walk/context_result.h"
#include "processors/walk/lines_under_way.h"
#include "processors/walk/second_level.h"
#include "processors/walk/waiting_time.h"

namespace marti::processors::node {

/// `Derived` has, beside what PacketNodes asks for: walker_, whose caches are guarded; step(node), read(node)
/// and write(node), called when the time has come of what the active context has stopped for;
/// prefetch(node, kind, line); pass(cursor), which moves a cursor past a transaction that has been served;
/// ready_after(node, context, time), when a context can go on whose transaction is done at `time`;
/// release_others(node), told that the active context has stopped, which may make others ready. The cursor of
/// the context that the node works on is in cursors_, those of its other contexts in contexts_.
template <class Derived, class Cursor>
class ContextCore : public PacketNodes<Derived, Cursor> {
  using Base = PacketNodes<Derived, Cursor>;

 public:
  void handle(const sim::Event& event) override {
    const std::uint32_t component = event.component();
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        if (event.sequence() == wake_sequence) {
          wake(component);
        } else {
          derived().step(component);
        }
        break;
      case EventClass::dispatch:
        dispatch(component);
        break;
      case EventClass::reply:
      case EventClass::memory:
        handle_memory(event);
        break;
      case EventClass::read:
        derived().read(component);
        break;
      case EventClass::write:
        derived().write(component);
        break;
    }
  }

  walk::ContextResult context_result() const override {
    return {static_cast<const Derived&>(*this).walker_.caches().counts()};
  }

 protected:
  using Base::begin_pixel;
  using Base::cursors_;
  using Base::end_;
  using Base::engine_;
  using Base::host_;
  using Base::input_;
  using Base::interconnect_of;
  using Base::place_of;
  using Base::port_of;
  using Base::ports_;
  using Base::spend;
  using Base::statistics_;
  using Base::watch;
  using Base::watch_misses;

  static constexpr std::uint32_t wake_sequence = 1;
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  // What a context waits for: none: it is ready; miss: a transaction of its own; line: a line that another
  // transaction brings; lock: another context or node to publish a branch; host: the start of its packet;
  // done: its last packet is done.
  enum class Wait : std::uint8_t { none, miss, line, lock, host, done };

  struct Context {
    Cursor cursor;                   // of this context, while the node works on another
    sim::Ticks ready = walk::never;  // when it is ready to continue; never while that is not known
    sim::Ticks locked = 0;           // lock: from when on it only waits for the branch
    std::uint64_t packet = 0;        // its number at the host
    std::uint32_t slot = 0;          // the transaction that it waits for
    Wait wait = Wait::none;
  };

  struct Core {
    sim::Ticks since = 0;           // when it began to wait
    sim::Ticks wake = walk::never;  // when the wait is known to end
    std::uint32_t active = 0;
    std::uint32_t live = 0;  // contexts that may still get a packet
    bool waiting = true;     // no context is ready
    bool fresh = true;       // no context has been worked on yet
    bool due = false;  // the walk has stopped at what other nodes may still change; an event of then goes on
  };

  ContextCore(const walk::ReplayInput& input, sim::Engine& engine, Host& host)
      : Base(input, engine, host),
        switch_(input.config.clock.cycles(input.config.switch_cycles)),
        cores_(input.config.all_nodes()),
        contexts_(std::size_t{input.config.all_nodes()} * input.config.contexts),
        services_(std::size_t{input.config.all_nodes()} * ports_) {
    for (Core& core : cores_) {
      core.live = input.config.contexts;
    }
  }

  // All contexts of a node ask for their first packets at `time`. A request by context c of node n has
  // component c * nodes + n, so all first contexts come first.
  void ask_for_packets(std::uint32_t node, sim::Ticks time) {
    for (std::uint32_t context = 0; context < input_.config.contexts; ++context) {
      Base::post(EventClass::dispatch, time, context * input_.config.all_nodes() + node);
    }
  }

  // Handles an event of the memory.
  void handle_memory(const sim::Event& event) {
    const std::uint32_t node = event.component() / ports_;
    const std::uint32_t port = port_of(node) + event.component() % ports_;
    if (static_cast<EventClass>(event.event_class()) == EventClass::reply) {
      Base::reply(node, port);
    } else {
      interconnect_of(node).proceed(port, event.sequence());
    }
  }

  [[nodiscard]] std::size_t context_bytes() const {
    return Base::common_bytes() + sizeof(Core) + input_.config.contexts * sizeof(Context) +
           ports_ * sizeof(memory::Service);
  }

  Context& context_of(std::uint32_t node, std::uint32_t context) {
    return contexts_[std::size_t{node} * input_.config.contexts + context];
  }
  // A prefetched line may arrive after all nodes are done; the frame ends when it has. What is built before
  // the frame waits for no prefetch.
  void count_late_arrivals() { end_ = std::max(end_, last_arrival_); }

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
      if (input_.causes != nullptr) {
        input_.causes->granted(node, number, now, grant->start);
      }
    }
    if (core.waiting) {
      expect(node, context.ready);
    } else if (number == core.active) {
      stall(node);
    }
  }

  // The lowest of the node's ports for prefetches that is not in use; ports_ when all are.
  std::uint32_t free_port(std::uint32_t node) {
    std::uint32_t slot = input_.config.contexts;
    while (slot < ports_ && service_of(node, slot).done > engine_.now()) {
      ++slot;
    }
    return slot;
  }

  // The active context waits for a line that transaction `slot` brings.
  void wait_for_line(std::uint32_t node, std::uint32_t slot) {
    Context& context = context_of(node, cores_[node].active);
    walk::ContextCounts& counts = counts_of(node);
    ++(slot < input_.config.contexts ? counts.joined : counts.late);
    context.wait = Wait::line;
    context.slot = slot;
    context.ready = service_of(node, slot).done;
    stall(node);
  }

  // The active context waits for a transaction of its own, which begins now.
  void wait_for_own(std::uint32_t node) {
    Context& context = context_of(node, cores_[node].active);
    context.wait = Wait::miss;
    context.slot = cores_[node].active;
    context.ready = walk::never;
  }

  // The active context begins to read the line that it has missed, and waits for it. With it the next line
  // may be prefetched.
  void read_missed(std::uint32_t node, memory::RecordKind kind, std::uint32_t line, memory::Address address,
                   std::uint32_t bytes) {
    const std::uint32_t slot = cores_[node].active;
    auto& caches = derived().walker_.caches();
    constexpr bool present = std::remove_reference_t<decltype(caches)>::present;
    wait_for_own(node);
    if constexpr (present) {
      caches.view(node).begin(kind, line, slot, engine_.now());
    }
    issue(node, slot, address, bytes);
    if constexpr (present) {
      if (input_.config.prefetch.next_line) {
        if (const auto next = caches.targets().next(kind, line)) {
          derived().prefetch(node, kind, *next);
        }
      }
    }
    stall(node);
  }

  // Fetches a line that nobody waits for, unless it is there or coming or too many are under way. True when
  // it is fetched.
  bool prefetch_line(std::uint32_t node, memory::RecordKind kind, std::uint32_t line) {
    auto& walker = derived().walker_;
    const auto cache = walker.caches().view(node);
    if (cache.has(kind, line, engine_.now())) {
      return false;
    }
    const std::uint32_t slot = free_port(node);
    if (slot == ports_) {
      ++cache.counts().dropped;
      return false;
    }
    cache.prefetch(kind, line, slot, engine_.now());
    if (const std::optional<sim::Ticks> hit = walker.second_level_hit(node, line)) {
      const sim::Ticks done = sim::add_ticks(engine_.now(), *hit);
      if (input_.causes != nullptr) {
        input_.causes->prefetched(node, slot, engine_.now(), done);
      }
      arrived(node, slot, walk::cache_access_until(done));
    } else {
      const std::uint32_t bytes = input_.config.cache.cache.line;
      issue(node, slot, memory::Address{line} * bytes, bytes);
    }
    return true;
  }

  void issue(std::uint32_t node, std::uint32_t slot, memory::Address address, std::uint32_t bytes) {
    service_of(node, slot).done = walk::never;
    Base::read_memory(node, {port_of(node) + slot, address, bytes});
  }

  // `port` is numbered through all nodes.
  void read_done(std::uint32_t port, const memory::Service& service) {
    const std::uint32_t node = port / ports_;
    const std::uint32_t slot = port % ports_;
    arrived(node, slot, service);
    for (std::uint32_t number = 0; number < input_.config.contexts; ++number) {
      Context& context = context_of(node, number);
      if ((context.wait == Wait::miss || context.wait == Wait::line) && context.slot == slot &&
          context.ready == walk::never) {
        context.ready = derived().ready_after(node, number, service.done);
        if (cores_[node].waiting) {
          expect(node, context.ready);
        }
      }
    }
  }

  // The course of a transaction is known.
  void arrived(std::uint32_t node, std::uint32_t slot, const memory::Service& service) {
    service_of(node, slot) = service;
    last_arrival_ = std::max(last_arrival_, service.done);
    auto& caches = derived().walker_.caches();
    if constexpr (std::remove_reference_t<decltype(caches)>::present) {
      caches.view(node).arrives(slot, service.done);
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
    derived().release_others(node);
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
    core.wake = walk::never;
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
    if (input_.causes != nullptr) {
      input_.causes->wait_ended(node, next, context.wait == Wait::host ? next : context.slot);
    }
    if (context.wait == Wait::host) {
      spend(node, cost::Activity::dispatch_wait, now - core.since);
      tell(node, walk::NodeState::dispatch_wait, core.since, now, {});
    } else {
      end_wait(node, next, core.since, now);
    }
    core.waiting = false;
    take_up(node, next, now);
  }

  // The node has waited from `since` to `now` for what this context has asked for.
  void end_wait(std::uint32_t node, std::uint32_t number, sim::Ticks since, sim::Ticks now) {
    const Context& context = context_of(node, number);
    const Cursor& cursor = cursor_of(node, number);
    const walk::PixelPlace place =
        Derived::for_pixel(cursor) ? walk::PixelPlace{cursor.x, cursor.y} : walk::PixelPlace{};
    resume_packet(node, number, cursor);
    const sim::Ticks locked = context.wait == Wait::lock ? std::max(since, context.locked) : now;
    if (locked != since) {
      end_read(node, service_of(node, context.slot), cursor, since, locked, place);
    }
    spend(node, cost::Activity::lock_wait, now - locked);
    tell(node, walk::NodeState::lock_wait, locked, now, place);
  }

  // The node has waited from `since` to `now` for what this read brings.
  void end_read(std::uint32_t node, const memory::Service& service, const Cursor& cursor, sim::Ticks since,
                sim::Ticks now, walk::PixelPlace place) {
    if (walk::is_cache_access(service)) {
      spend(node, cost::Activity::cache_access, now - since);
      tell(node, walk::NodeState::working, since, now, place);
      return;
    }
    const memory::Service waited = walk::last_part(service, now - since);
    spend(node, waited);
    derived().walker_.note_wait(cursor, waited);
    if (input_.observer != nullptr) {
      walk::spent_reading(*input_.observer, node, waited, since, place);
    }
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
      resume_packet(node, number, cursor);
    }
    cursor.time = now;
    if (other && !core.fresh) {
      cursor.time = sim::add_ticks(now, switch_);
      spend(node, cost::Activity::switching, switch_);
      ++counts_of(node).switches;
      watch(node, walk::NodeState::working, now);
    }
    core.fresh = false;
    context.ready = walk::never;
    const Wait waited = std::exchange(context.wait, Wait::none);
    if (waited == Wait::miss) {
      derived().pass(cursor);
    } else if (waited == Wait::host && input_.observer != nullptr) {
      input_.observer->began_packet(node, context.packet, cursor.time);
    }
    derived().run(node);
  }

  // Tells the observer that what follows is for the packet of this context, if it has one.
  void resume_packet(std::uint32_t node, std::uint32_t number, const Cursor& cursor) {
    if (input_.observer != nullptr && Derived::for_pixel(cursor)) {
      input_.observer->resumed_packet(node, context_of(node, number).packet);
    }
  }
  void tell(std::uint32_t node, walk::NodeState state, sim::Ticks from, sim::Ticks to,
            walk::PixelPlace place) {
    if (input_.observer != nullptr && from != to) {
      if (state == walk::NodeState::working) {
        Base::watch_work(node, false);
      }
      input_.observer->spent(node, state, from, to, place);
    }
  }

 private:
  Derived& derived() { return static_cast<Derived&>(*this); }
  walk::ContextCounts& counts_of(std::uint32_t node) {
    return derived().walker_.caches().view(node).counts();
  }

  sim::Ticks switch_;

 protected:
  sim::LargeVector<Core> cores_;
  sim::LargeVector<Context> contexts_;  // node by node
  sim::Ticks last_arrival_ = 0;
  // The last transaction of each port, node by node; done is `never` while its end is not known.
  sim::LargeVector<memory::Service> services_;
};

}  // namespace marti::processors::node
