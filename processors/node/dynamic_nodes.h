// Nodes of the image scheme on a machine whose tree is built while it is used. Packets, misses and pixel
// writes are as in ImageNodes; in addition there are the building before the frame, locks, waits for a lock,
// and writes of the tree.
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "processors/node/build_report.h"
#include "processors/node/dynamic_walker.h"
#include "processors/node/packet_nodes.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h. The members are described in node_array.h.
template <class Caches>
class DynamicNodes final : public PacketNodes<DynamicNodes<Caches>, DynamicCursor> {
  using Base = PacketNodes<DynamicNodes<Caches>, DynamicCursor>;
  friend Base;
  using Base::cursors_;
  using Base::dispatch;
  using Base::end_;
  using Base::has_room;
  using Base::input_;
  using Base::interconnect_of;
  using Base::last_write_done_;
  using Base::make_write;
  using Base::port_of;
  using Base::post;
  using Base::spend;
  using Base::statistics_;
  using Base::watch;
  using Base::watch_read;
  using Base::write_pixel;

 public:
  DynamicNodes(const ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : Base(input, engine, host), walker_(input, std::move(caches)), built_(input.config.all_nodes()) {}

  void start(std::uint64_t seed) override {
    order_ = Base::first_order(seed);
    for (const std::uint32_t node : order_) {
      if (!input_.tree->eager().empty() && builds_before(node)) {
        cursors_[node].before = true;
        ++builders_left_;
        post(EventClass::step, 0, node);
      }
    }
    if (builders_left_ == 0) {
      begin_frame();
    }
  }

  void handle(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        cursors_[node].due = true;
        run(node);
        break;
      case EventClass::dispatch:
        dispatch(node);
        break;
      case EventClass::reply:
        interconnect_of(node).reply(port_of(node));
        break;
      case EventClass::memory:
        interconnect_of(node).proceed(port_of(node), event.sequence());
        break;
      case EventClass::read:
        if (cursors_[node].todo == Todo::lock) {
          lock(node);
        } else {
          read(node);
        }
        break;
      case EventClass::write:
        write(node);
        break;
    }
  }

  void finish() override {
    for (std::size_t node = 0; node < statistics_.size(); ++node) {
      NodeStatistics& statistics = statistics_[node];
      add_counted_time(walker_.ticks(), statistics.steps, statistics.references.all_hits(), statistics.time);
      add_building_time(walker_.times(), built_[node], statistics.time);
      statistics.time[static_cast<std::size_t>(Activity::idle)] = end_ - statistics.finish;
    }
    Base::watch_idle();
  }

  SecondLevelResult second_level() const override { return walker_.second_level().result(); }

  BuildResult build_result() const override {
    BuildResult result = report_build(input_, walker_.copies());
    result.start_up = start_up_;
    result.start_up_wait = start_up_wait_;
    result.nodes.assign(built_.begin(), built_.end());
    return result;
  }

  std::size_t bytes_per_node() const override { return Base::common_bytes() + sizeof(BuildCounts); }

 private:
  static constexpr std::uint32_t none = DynamicCursor::none;

  static bool for_pixel(const DynamicCursor& cursor) { return !cursor.before; }

  // The first node of each cluster builds the database's tree; with a replicated database every node does.
  bool builds_before(std::uint32_t node) const {
    return input_.config.placement == Placement::replicated || port_of(node) == 0;
  }

  // A builder has nothing left to split. The frame begins when all builders are ready and their writes done.
  void ready(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    cursor.before = false;
    start_up_ = std::max(start_up_, cursor.time);
    --builders_left_;
    begin_frame_if_ready();
  }

  void writes_are_known() { begin_frame_if_ready(); }

  void begin_frame_if_ready() {
    if (!begun_ && builders_left_ == 0 && Base::all_writes_known()) {
      start_up_ = std::max(start_up_, end_);
      begin_frame();
    }
  }

  void begin_frame() {
    begun_ = true;
    for (const std::uint32_t node : order_) {
      const sim::Ticks wait = start_up_ - cursors_[node].time;
      spend(node, Activity::dispatch_wait, wait);
      start_up_wait_ = sim::add_ticks(start_up_wait_, wait);
      const sim::Ticks from = std::exchange(cursors_[node].time, start_up_);
      watch(node, NodeState::dispatch_wait, from, false);
      post(EventClass::dispatch, start_up_, node);
    }
  }

  // Lets a node work until it needs something shared.
  void run(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    const bool for_frame = for_pixel(cursor);
    const sim::Ticks from = cursor.time;
    const DynamicStop stop =
        input_.step_by_step ? walker_.template advance<false>(node, cursor, statistics_[node], built_[node])
                            : walker_.template advance<true>(node, cursor, statistics_[node], built_[node]);
    watch(node, NodeState::working, from, for_frame);
    switch (stop) {
      case DynamicStop::due:
        post(EventClass::step, cursor.time, node);
        break;
      case DynamicStop::miss:
      case DynamicStop::lock:
        post(EventClass::read, cursor.time, node);
        break;
      case DynamicStop::write:
        post(EventClass::write, cursor.time, node);
        break;
      case DynamicStop::ready:
        ready(node);
        break;
    }
  }

  void read(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    const sim::Ticks from = cursor.time;
    if (!walker_.miss(node, cursor, statistics_[node])) {
      watch(node, NodeState::working, from, for_pixel(cursor));
      run(node);
      return;
    }
    interconnect_of(node).read({port_of(node), walker_.address(cursor), walker_.bytes(cursor)});
  }

  // The first lock transaction for a branch wins.
  void lock(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    TreeCopies& copies = walker_.copies();
    const std::uint32_t copy = copies.copy_of(node);
    const std::uint32_t lazy = input_.tree->place(cursor.node).lazy;
    ++built_[node].locks;
    if (copies.built(copy, lazy)) {
      cursor.lock = Lock::built;
    } else if (copies.taken(copy, lazy)) {
      cursor.lock = Lock::wait;
      ++built_[node].waits;
      cursor.published = -1;
      cursor.arrived = -1;
      DynamicCursor& builder = cursors_[copies.builder(copy, lazy)];
      cursor.next_waiter = builder.first_waiter;
      builder.first_waiter = node;
    } else {
      cursor.lock = Lock::won;
      copies.take(copy, lazy, node);
    }
    interconnect_of(node).read({port_of(node), walker_.locked_address(node, cursor),
                                std::min(input_.config.word_bytes, input_.config.layout.node_bytes)});
  }

  void read_done(std::uint32_t node, const memory::Service& service) {
    spend(node, service);
    DynamicCursor& cursor = cursors_[node];
    watch_read(node, service, for_pixel(cursor));
    cursor.time = service.done;
    if (cursor.todo != Todo::lock) {
      walker_.pass(cursor);
    } else if (cursor.lock == Lock::wait) {
      cursor.arrived = service.done;
      go_on_waiting(node);
      return;
    }
    run(node);
  }

  // Lets a waiting node continue once both its lock transaction and the time of publication are known.
  void go_on_waiting(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    if (cursor.arrived < 0 || cursor.published < 0) {
      return;
    }
    cursor.time = std::max(cursor.arrived, cursor.published);
    spend(node, Activity::lock_wait, cursor.time - cursor.arrived);
    watch(node, NodeState::lock_wait, cursor.arrived);
    post(EventClass::step, cursor.time, node);
  }

  void write(std::uint32_t node) {
    if (!has_room(node)) {
      return;
    }
    if (cursors_[node].todo == Todo::step) {
      write_pixel(node);
    } else {
      write_tree(node);
    }
  }

  // Writes a part of a record or list of the tree. Copies of its line in other caches of the cluster become
  // stale and are removed; the node's own copy is updated.
  void write_tree(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    const memory::Address address = walker_.address(cursor);
    const std::uint32_t bytes = walker_.bytes(cursor);
    ++built_[node].writes;
    built_[node].written_bytes += bytes;
    if constexpr (Caches::present) {
      take_out(node, address);
    }
    make_write(node, address, bytes);
    walker_.pass(cursor);
    if (walker_.publishes(cursor)) {
      publish(node);
    }
    run(node);
  }

  void take_out(std::uint32_t node, memory::Address address) {
    const auto line = static_cast<std::uint32_t>(address / input_.config.cache.cache.line);
    if (!walker_.copies().maybe_cached(walker_.copies().copy_of(node), line)) {
      return;
    }
    const std::uint32_t first = node - port_of(node);
    for (std::uint32_t other = first; other < first + input_.config.nodes; ++other) {
      if (other != node) {
        built_[node].invalidations += walker_.take_out(other, line);
      }
    }
  }

  void publish(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    TreeCopies& copies = walker_.copies();
    copies.publish(copies.copy_of(node), input_.tree->place(cursor.node).lazy);
    for (std::uint32_t waiter = std::exchange(cursor.first_waiter, none); waiter != none;) {
      DynamicCursor& waiting = cursors_[waiter];
      const std::uint32_t next = std::exchange(waiting.next_waiter, none);
      waiting.published = last_write_done_;
      go_on_waiting(waiter);
      waiter = next;
    }
  }

  DynamicWalker<Caches> walker_;
  sim::LargeVector<BuildCounts> built_;
  std::vector<std::uint32_t> order_;  // in which first events are posted; does not change the result
  std::uint32_t builders_left_ = 0;
  bool begun_ = false;
  sim::Ticks start_up_ = 0;
  sim::Ticks start_up_wait_ = 0;
};

}  // namespace marti::processors
