// What nodes have in common that build the tree while they use it, with one context or several: the building
// before the frame, locks, writes of the tree, and its publication. Packets and pixel writes are as in every
// scheme of packets.
//
// A worker is a context of a node, numbered node * contexts + context.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "processors/node/build_report.h"
#include "processors/node/dynamic_walker.h"
#include "processors/node/packet_nodes.h"

namespace marti::processors::node {

/// `Base` is PacketNodes, or ContextCore, with `Derived` and DynamicCursor. `Derived` has, beside what `Base`
/// asks for: ask_first(node, time), by which the node asks for its first packets; note_stop(node, stop), told
/// why the node's work has stopped; go_on(worker), called when it becomes known from when on a branch that
/// the worker waits for can be seen.
template <class Derived, class Base, class Caches>
class BuildingNodes : public Base {
 protected:
  using Base::cursors_;
  using Base::end_;
  using Base::has_room;
  using Base::input_;
  using Base::last_write_done_;
  using Base::make_write;
  using Base::port_of;
  using Base::post;
  using Base::spend;
  using Base::statistics_;
  using Base::watch;
  using Base::write_pixel;

  static constexpr std::uint32_t none = DynamicCursor::none;

  // The wait of a worker that did not win a lock; a time that is not known yet is -1.
  struct LockWait {
    sim::Ticks arrived = 0;             // when the lock transaction is done
    sim::Ticks published = 0;           // when the branch can be seen
    std::uint32_t first_waiter = none;  // list of the workers that wait for this one to publish
    std::uint32_t next_waiter = none;   // in the list that this one waits in
  };

 public:
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

  void finish() override {
    for (std::size_t node = 0; node < statistics_.size(); ++node) {
      cost::NodeStatistics& statistics = statistics_[node];
      cost::add_counted_time(walker_.ticks(), statistics.steps, statistics.references.all_hits(),
                             statistics.time);
      add_building_time(walker_.times(), built_[node], statistics.time);
      statistics.time[static_cast<std::size_t>(cost::Activity::idle)] = end_ - statistics.finish;
    }
    Base::watch_idle();
  }

  walk::SecondLevelResult second_level() const override { return walker_.second_level().result(); }

  walk::CacheCountResult cache_counts() const override { return walker_.counts(); }

  BuildResult build_result() const override {
    BuildResult result = report_build(input_, walker_.copies());
    result.start_up = start_up_;
    result.start_up_wait = start_up_wait_;
    result.nodes.assign(built_.begin(), built_.end());
    return result;
  }

 protected:
  BuildingNodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : Base(input, engine, host),
        walker_(input, std::move(caches)),
        built_(input.config.all_nodes()),
        lock_waits_(std::size_t{input.config.all_nodes()} * input.config.contexts) {}

  [[nodiscard]] std::size_t building_bytes() const {
    return sizeof(BuildCounts) + input_.config.contexts * sizeof(LockWait);
  }

  static bool for_pixel(const DynamicCursor& cursor) { return !cursor.before; }

  // The first node of each cluster builds the database's tree; with a replicated database every node does.
  bool builds_before(std::uint32_t node) const {
    return input_.config.placement == machine::Placement::replicated || port_of(node) == 0;
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
    if (input_.causes != nullptr) {
      input_.causes->began_frame(start_up_);
    }
    for (const std::uint32_t node : order_) {
      const sim::Ticks wait = start_up_ - cursors_[node].time;
      spend(node, cost::Activity::dispatch_wait, wait);
      start_up_wait_ += wait;
      const sim::Ticks from = std::exchange(cursors_[node].time, start_up_);
      watch(node, walk::NodeState::dispatch_wait, from, false);
      derived().ask_first(node, start_up_);
    }
  }

  // A worker's lock transaction is decided; it is a read that is then made. The first one for a branch wins.
  memory::Transaction lock(std::uint32_t node, std::uint32_t worker) {
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
      LockWait& wait = lock_waits_[worker];
      LockWait& builder = lock_waits_[copies.builder(copy, lazy)];
      wait.published = -1;
      wait.arrived = -1;
      wait.next_waiter = std::exchange(builder.first_waiter, worker);
    } else {
      cursor.lock = Lock::won;
      copies.take(copy, lazy, worker);
    }
    return {port_of(node) + worker % input_.config.contexts, walker_.locked_address(node, cursor),
            std::min(input_.config.word_bytes, input_.config.layout.node_bytes)};
  }

  // When a worker that waits for a branch can go on; LockWait's -1 while that is not known.
  [[nodiscard]] sim::Ticks released(std::uint32_t worker) const {
    const LockWait& wait = lock_waits_[worker];
    return wait.arrived < 0 || wait.published < 0 ? -1 : std::max(wait.arrived, wait.published);
  }

  // Continues the worker that the node works on. Misses are classed with a cache of another shape, in which
  // the order of using a line and removing another does matter, so then nothing is taken ahead of its time.
  DynamicStop advance(std::uint32_t node) {
    return input_.step_by_step || input_.config.count.miss_classes
               ? walker_.template advance<false>(node, cursors_[node], statistics_[node], built_[node])
               : walker_.template advance<true>(node, cursors_[node], statistics_[node], built_[node]);
  }

  // Works on the node's present worker until it needs something shared.
  void run(std::uint32_t node) {
    const DynamicCursor& cursor = cursors_[node];
    const bool for_frame = for_pixel(cursor);
    const sim::Ticks from = cursor.time;
    const DynamicStop stop = advance(node);
    watch(node, walk::NodeState::working, from, for_frame);
    derived().note_stop(node, stop);
    switch (stop) {
      case DynamicStop::due:
        post(EventClass::step, cursor.time, node);
        break;
      case DynamicStop::miss:
      case DynamicStop::lock:
      case DynamicStop::line:
      case DynamicStop::children:
      case DynamicStop::other:
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

  // Whether the reference that missed has to be read from memory. If not, the second level has it, and the
  // worker has gone on.
  bool reads_memory(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    const sim::Ticks from = cursor.time;
    if (walker_.miss(node, cursor, statistics_[node])) {
      return true;
    }
    watch(node, walk::NodeState::working, from, for_pixel(cursor));
    run(node);
    return false;
  }

  // Writes what the worker has stopped for: a pixel, or a part of the tree.
  void write_next(std::uint32_t node, std::uint32_t worker) {
    const bool pixel = cursors_[node].todo == Todo::step;
    const bool writes = !pixel || input_.config.pixels == machine::Pixels::written;
    if (writes && !has_room(node)) {
      return;
    }
    if (pixel) {
      write_pixel(node);
    } else {
      write_tree(node, worker);
    }
  }

  // Writes a part of a record or list of the tree. Copies of its line in other caches of the cluster become
  // stale and are removed; the node's own copy is updated.
  void write_tree(std::uint32_t node, std::uint32_t worker) {
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
      publish(node, worker);
    }
    derived().run(node);
  }

  void take_out(std::uint32_t node, memory::Address address) {
    const auto line = static_cast<std::uint32_t>(address / input_.config.cache.cache.line);
    if (!walker_.copies().maybe_cached(walker_.copies().copy_of(node), line)) {
      return;
    }
    const std::uint32_t first = Base::cluster_of(node) * input_.config.nodes;
    for (std::uint32_t other = first; other < first + input_.config.nodes; ++other) {
      if (other != node) {
        built_[node].invalidations += walker_.take_out(other, line);
      }
    }
  }

  void publish(std::uint32_t node, std::uint32_t worker) {
    TreeCopies& copies = walker_.copies();
    copies.publish(copies.copy_of(node), input_.tree->place(cursors_[node].node).lazy);
    for (std::uint32_t waiter = std::exchange(lock_waits_[worker].first_waiter, none); waiter != none;) {
      const std::uint32_t next = std::exchange(lock_waits_[waiter].next_waiter, none);
      lock_waits_[waiter].published = last_write_done_;
      if (input_.causes != nullptr) {
        input_.causes->published(node, waiter);
      }
      derived().go_on(waiter);
      waiter = next;
    }
  }

  DynamicWalker<Caches> walker_;
  sim::LargeVector<BuildCounts> built_;
  sim::LargeVector<LockWait> lock_waits_;  // by worker

 private:
  Derived& derived() { return static_cast<Derived&>(*this); }

  std::vector<std::uint32_t> order_;  // in which first events are posted; does not change the result
  std::uint32_t builders_left_ = 0;
  bool begun_ = false;
  sim::Ticks start_up_ = 0;
  sim::Sum start_up_wait_ = 0;
};

}  // namespace marti::processors::node
