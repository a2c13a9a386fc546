// Nodes of the image scheme that build the tree while they use it and hide their misses: several contexts
// (context_core.h), prefetching, or both, with what building_nodes.h describes.
#pragma once

#include <utility>

#include "processors/node/building_nodes.h"
#include "processors/node/context_core.h"
#include "processors/walk/guarded_caches.h"

namespace marti::processors::node {

template <class Caches>
class ContextBuildingNodes;

template <class Caches>
using ContextBuildingBase =
    BuildingNodes<ContextBuildingNodes<Caches>, ContextCore<ContextBuildingNodes<Caches>, DynamicCursor>,
                  walk::GuardedCaches<Caches>>;

/// `Caches` is one of node_caches.h, or CountedCaches. The members are described in node_array.h.
template <class Caches>
class ContextBuildingNodes final : public ContextBuildingBase<Caches> {
  using Base = ContextBuildingBase<Caches>;
  using Scheduler = ContextCore<ContextBuildingNodes<Caches>, DynamicCursor>;
  friend Base;
  friend Scheduler;
  friend PacketNodes<ContextBuildingNodes<Caches>, DynamicCursor>;
  using Base::context_of;
  using Base::cores_;
  using Base::cursor_of;
  using Base::cursors_;
  using Base::engine_;
  using Base::expect;
  using Base::input_;
  using Base::issue;
  using Base::lock_waits_;
  using Base::stall;
  using Base::walker_;
  using typename Scheduler::Context;
  using typename Scheduler::Wait;

 public:
  ContextBuildingNodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : Base(input, engine, host, walk::GuardedCaches<Caches>(input, std::move(caches))),
        stops_(input.config.all_nodes()) {}

  void finish() override {
    Base::count_late_arrivals();
    Base::finish();
  }

  std::size_t bytes_per_node() const override { return Base::context_bytes() + Base::building_bytes(); }

 private:
  // The worker that the node works on.
  std::uint32_t worker_of(std::uint32_t node) const {
    return node * input_.config.contexts + cores_[node].active;
  }

  void ask_first(std::uint32_t node, sim::Ticks time) {
    Base::watch_misses(node, {});  // misses before the frame belong to no pixel
    auto& core = cores_[node];
    core.waiting = true;
    core.fresh = true;
    core.since = time;
    core.wake = walk::never;
    Base::ask_for_packets(node, time);
  }

  void pass(DynamicCursor& cursor) const {
    if (cursor.todo != Todo::lock) {
      walker_.pass(cursor);
    }
  }
  void step(std::uint32_t node) {
    cores_[node].waiting = false;  // it waits only before the first step of building
    cursors_[node].due = true;
    Base::run(node);
  }
  void write(std::uint32_t node) { Base::write_next(node, worker_of(node)); }

  // A context whose lock transaction was too late has to wait for the branch, too.
  sim::Ticks ready_after(std::uint32_t node, std::uint32_t number, sim::Ticks done) {
    Context& context = context_of(node, number);
    const DynamicCursor& cursor = cursor_of(node, number);
    if (context.wait != Wait::miss || cursor.todo != Todo::lock || cursor.lock != Lock::wait) {
      return done;
    }
    const std::uint32_t worker = node * input_.config.contexts + number;
    lock_waits_[worker].arrived = done;
    context.wait = Wait::lock;
    context.locked = done;
    return Base::released(worker) < 0 ? walk::never : Base::released(worker);
  }

  // It has become known when the branch can be seen that the worker waits for.
  void go_on(std::uint32_t worker) {
    const std::uint32_t node = worker / input_.config.contexts;
    Context& context = context_of(node, worker % input_.config.contexts);
    if (Base::released(worker) < 0) {
      return;
    }
    context.ready = Base::released(worker);
    if (cores_[node].waiting) {
      expect(node, context.ready);
    }
  }

  void note_stop(std::uint32_t node, DynamicStop stop) { stops_[node] = stop; }

  // The time has come of what the active context has stopped for.
  void read(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    switch (stops_[node]) {
      case DynamicStop::lock: {
        Base::wait_for_own(node);
        const memory::Transaction transaction = Base::lock(node, worker_of(node));
        issue(node, cores_[node].active, transaction.address, transaction.bytes);
        stall(node);
        break;
      }
      case DynamicStop::line: {
        const auto cache = walker_.caches().view(node);
        const std::uint32_t slot = cache.awaits(cursor.kind, line_at(cursor.at), engine_.now());
        if (slot == walk::LinesUnderWay::none) {
          cursor.due = true;
          Base::run(node);
        } else {
          cursor.due = false;
          Base::wait_for_line(node, slot);
        }
        break;
      }
      case DynamicStop::children:
        walker_.each_child_line(walker_.copies().copy_of(node), cursor.children, [&](std::uint32_t line) {
          prefetch(node, memory::RecordKind::node, line);
          return true;
        });
        cursor.children = DynamicCursor::none;
        Base::run(node);
        break;
      case DynamicStop::other:
        wait_for_other(node);
        break;
      default:
        miss(node);
    }
  }

  // The active context waits for another one of the node, which splits a branch of the node's own tree.
  void wait_for_other(std::uint32_t node) {
    Context& context = context_of(node, cores_[node].active);
    context.wait = Wait::lock;
    context.locked = engine_.now();
    context.ready = walk::never;
    stall(node);
  }
  // Lets the contexts go on that wait for a branch of the node's own tree which is split now. Called when the
  // active context has stopped, before another one is taken up.
  void release_others(std::uint32_t node) {
    if (input_.config.build.sharing != machine::Sharing::private_trees) {
      return;
    }
    for (std::uint32_t number = 0; number < input_.config.contexts; ++number) {
      Context& context = context_of(node, number);
      if (context.wait == Wait::lock && !walker_.is_being_split(node, cursor_of(node, number))) {
        context.ready = std::min(context.ready, engine_.now());
      }
    }
  }

  void miss(std::uint32_t node) {
    if (Base::reads_memory(node)) {
      const DynamicCursor& cursor = cursors_[node];
      Base::read_missed(node, cursor.kind, line_at(cursor.at), walker_.address(cursor),
                        walker_.bytes(cursor));
    }
  }

  std::uint32_t line_at(memory::Address address) const {
    return static_cast<std::uint32_t>(address / input_.config.reference_bytes());
  }

  void prefetch(std::uint32_t node, memory::RecordKind kind, std::uint32_t line) {
    if (Base::prefetch_line(node, kind, line)) {
      walker_.note_cached(node, line);
    }
  }

  sim::LargeVector<DynamicStop> stops_;  // why the active context of each node stopped last
};

}  // namespace marti::processors::node
