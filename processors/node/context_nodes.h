// Nodes of the image scheme that hide their misses: each holds several packets, its contexts
// (context_core.h), and on a miss switches to the next one that is ready. Lines may be prefetched.
#pragma once

#include <utility>

#include "processors/cost/step_time.h"
#include "processors/node/context_core.h"
#include "processors/walk/guarded_caches.h"
#include "processors/walk/log_walker.h"

namespace marti::processors::node {

/// `Caches` is one of node_caches.h, or CountedCaches. The members are described in node_array.h.
template <class Caches>
class ContextNodes final : public ContextCore<ContextNodes<Caches>, walk::Cursor> {
  using Base = ContextCore<ContextNodes<Caches>, walk::Cursor>;
  friend Base;
  friend PacketNodes<ContextNodes<Caches>, walk::Cursor>;
  using Base::cores_;
  using Base::cursors_;
  using Base::end_;
  using Base::engine_;
  using Base::has_room;
  using Base::input_;
  using Base::post;
  using Base::statistics_;
  using Base::watch;
  using Base::write_pixel;

 public:
  ContextNodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : Base(input, engine, host), walker_(input, walk::GuardedCaches<Caches>(input, std::move(caches))) {}

  void start(std::uint64_t seed) override {
    for (const std::uint32_t node : Base::first_order(seed)) {
      Base::ask_for_packets(node, 0);
    }
  }

  void finish() override {
    Base::count_late_arrivals();
    for (cost::NodeStatistics& node : statistics_) {
      cost::add_counted_time(walker_.ticks(), node.steps, node.references.all_hits(), node.time);
      node.time[static_cast<std::size_t>(cost::Activity::idle)] = end_ - node.finish;
    }
    Base::watch_idle();
  }

  walk::SecondLevelResult second_level() const override { return walker_.behind().second_level().result(); }

  walk::CacheCountResult cache_counts() const override { return walker_.counts(); }

  std::size_t bytes_per_node() const override { return Base::context_bytes(); }

 private:
  static bool for_pixel(const walk::Cursor& /*cursor*/) { return true; }
  void pass(walk::Cursor& cursor) const { walker_.pass(cursor); }
  static sim::Ticks ready_after(std::uint32_t /*node*/, std::uint32_t /*number*/, sim::Ticks done) {
    return done;
  }
  static void release_others(std::uint32_t /*node*/) {}

  void step(std::uint32_t node) { run(node); }
  void write(std::uint32_t node) {
    if (has_room(node)) {
      write_pixel(node);
    }
  }

  // Works on the active context until it needs something shared.
  void run(std::uint32_t node) {
    walk::Cursor& cursor = cursors_[node];
    cost::NodeStatistics& statistics = statistics_[node];
    const sim::Ticks from = cursor.time;
    const walk::Stop stop = input_.step_by_step ? walker_.template advance<false>(node, cursor, statistics)
                                                : walker_.template advance<true>(node, cursor, statistics);
    if (stop == walk::Stop::end) {
      walker_.finish_pixel(node, cursor, statistics);
    }
    watch(node, walk::NodeState::working, from);
    cores_[node].due = stop == walk::Stop::due;
    switch (stop) {
      case walk::Stop::hit:
        post(EventClass::step, cursor.time, node);
        break;
      case walk::Stop::miss:
      case walk::Stop::due:
        post(EventClass::read, cursor.time, node);
        break;
      case walk::Stop::end:
        post(EventClass::write, cursor.time, node);
        break;
    }
  }

  void read(std::uint32_t node) {
    walk::Cursor& cursor = cursors_[node];
    const auto cache = walker_.caches().view(node);
    if (!cores_[node].due) {
      Base::read_missed(node, cursor.kind, line_of(cursor), walker_.missed_address(cursor),
                        walker_.missed_bytes(cursor));
      return;
    }
    if (cursor.branch != walk::Cursor::no_branch && cursor.at >= cursor.end) {
      walker_.caches().targets().each_child_line(cursor.branch, [&](std::uint32_t line) {
        prefetch(node, memory::RecordKind::node, line);
        return true;
      });
      cursor.branch = walk::Cursor::no_branch;
      run(node);
      return;
    }
    const std::uint32_t slot = cache.awaits(cursor.kind, line_of(cursor), engine_.now());
    if (slot == walk::LinesUnderWay::none) {
      run(node);
    } else {
      Base::wait_for_line(node, slot);
    }
  }

  std::uint32_t line_of(const walk::Cursor& cursor) const {
    return static_cast<std::uint32_t>(walker_.missed_address(cursor) / input_.config.cache.cache.line);
  }

  void prefetch(std::uint32_t node, memory::RecordKind kind, std::uint32_t line) {
    (void)Base::prefetch_line(node, kind, line);
  }

  walk::LogWalker<walk::GuardedCaches<Caches>> walker_;
};

}  // namespace marti::processors::node
