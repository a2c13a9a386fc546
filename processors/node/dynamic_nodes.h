// Nodes of the image scheme, with one context each, on a machine whose tree is built while it is used.
// Packets, misses and pixel writes are as in ImageNodes; in addition there is what building_nodes.h
// describes.
#pragma once

#include <utility>

#include "processors/node/building_nodes.h"

namespace marti::processors::node {

template <class Caches>
class DynamicNodes;

template <class Caches>
using DynamicNodesBase =
    BuildingNodes<DynamicNodes<Caches>, PacketNodes<DynamicNodes<Caches>, DynamicCursor>, Caches>;

/// `Caches` is one of node_caches.h, or CountedCaches. The members are described in node_array.h.
template <class Caches>
class DynamicNodes final : public DynamicNodesBase<Caches> {
  using Base = DynamicNodesBase<Caches>;
  friend Base;
  friend PacketNodes<DynamicNodes<Caches>, DynamicCursor>;
  using Base::cursors_;
  using Base::dispatch;
  using Base::for_pixel;
  using Base::interconnect_of;
  using Base::lock_waits_;
  using Base::port_of;
  using Base::post;
  using Base::spend;
  using Base::walker_;
  using Base::watch;
  using Base::watch_read;

 public:
  DynamicNodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : Base(input, engine, host, std::move(caches)) {}

  void handle(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        cursors_[node].due = true;
        Base::run(node);
        break;
      case EventClass::dispatch:
        dispatch(node);
        break;
      case EventClass::reply:
        Base::reply(node, port_of(node));
        break;
      case EventClass::memory:
        interconnect_of(node).proceed(port_of(node), event.sequence());
        break;
      case EventClass::read:
        if (cursors_[node].todo == Todo::lock) {
          interconnect_of(node).read(Base::lock(node, node));
        } else {
          read(node);
        }
        break;
      case EventClass::write:
        Base::write_next(node, node);
        break;
    }
  }

  std::size_t bytes_per_node() const override { return Base::common_bytes() + Base::building_bytes(); }

 private:
  void ask_first(std::uint32_t node, sim::Ticks time) { post(EventClass::dispatch, time, node); }

  static void note_stop(std::uint32_t /*node*/, DynamicStop stop) {
    sim::ensure(stop != DynamicStop::line && stop != DynamicStop::children && stop != DynamicStop::other,
                "a node with one context has nothing under way beside its work");
  }

  void read(std::uint32_t node) {
    if (Base::reads_memory(node)) {
      const DynamicCursor& cursor = cursors_[node];
      Base::read_memory(node, {port_of(node), walker_.address(cursor), walker_.bytes(cursor)});
    }
  }

  void read_done(std::uint32_t node, const memory::Service& service) {
    spend(node, service);
    DynamicCursor& cursor = cursors_[node];
    watch_read(node, service, for_pixel(cursor));
    walker_.note_wait(cursor, service);
    cursor.time = service.done;
    if (cursor.todo != Todo::lock) {
      walker_.pass(cursor);
    } else if (cursor.lock == Lock::wait) {
      lock_waits_[node].arrived = service.done;
      go_on(node);
      return;
    }
    Base::run(node);
  }

  // Lets a waiting node continue once both its lock transaction and the time of publication are known.
  void go_on(std::uint32_t node) {
    if (Base::released(node) < 0) {
      return;
    }
    const sim::Ticks arrived = lock_waits_[node].arrived;
    DynamicCursor& cursor = cursors_[node];
    cursor.time = Base::released(node);
    spend(node, cost::Activity::lock_wait, cursor.time - arrived);
    watch(node, walk::NodeState::lock_wait, arrived);
    post(EventClass::step, cursor.time, node);
  }
};

}  // namespace marti::processors::node
