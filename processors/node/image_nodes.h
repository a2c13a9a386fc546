// Nodes of the image scheme: each takes a packet of neighbouring pixels and traces it whole.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "processors/cost/step_time.h"
#include "processors/node/packet_nodes.h"
#include "processors/walk/log_walker.h"
#include "processors/walk/node_caches.h"
#include "sim/prefetch.h"

namespace marti::processors::node {

/// `Caches` is one of node_caches.h, `Walker` is LogWalker or StrippedWalker with them. The members are
/// described in node_array.h.
template <class Caches, class Walker = walk::LogWalker<Caches>>
class ImageNodes final : public PacketNodes<ImageNodes<Caches, Walker>, walk::Cursor> {
  using Base = PacketNodes<ImageNodes<Caches, Walker>, walk::Cursor>;
  friend Base;
  using Base::cursors_;
  using Base::dispatch;
  using Base::end_;
  using Base::has_room;
  using Base::input_;
  using Base::interconnect_of;
  using Base::port_of;
  using Base::post;
  using Base::spend;
  using Base::statistics_;
  using Base::watch;
  using Base::watch_read;
  using Base::write_pixel;

 public:
  ImageNodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : Base(input, engine, host),
        walker_(input, std::move(caches)),
        begun_(input.sample == nullptr ? 0 : input.config.all_nodes()) {}

  void start(std::uint64_t seed) override {
    for (const std::uint32_t node : Base::first_order(seed)) {
      post(EventClass::dispatch, 0, node);
    }
  }

  [[gnu::always_inline]] void handle(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        run(node);
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
        read(node);
        break;
      case EventClass::write:
        if (has_room(node)) {
          write_pixel(node);
        }
        break;
    }
  }

  // Only the events of data that are ready are posted in order.
  void handle_in_order(const sim::Event& event) {
    if (event.event_class() != static_cast<std::uint8_t>(EventClass::reply)) [[unlikely]] {
      throw sim::InternalError("an event that is no reply was posted in order");
    }
    Base::reply(event.component(), port_of(event.component()));
  }

  void run_all(sim::Engine& engine) override { engine.run_all(*this); }
  void run_before(sim::Engine& engine, sim::Ticks end) override { engine.run_before(*this, end); }
  void grant(std::uint32_t node, const std::optional<Grant>& grant) override { Base::begin(node, grant); }

  void prepare(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    interconnect_of(node).prepare(port_of(node));
    sim::prefetch_line(&cursors_[node]);
    if (event.event_class() == static_cast<std::uint8_t>(EventClass::reply)) {
      prepare_reply(node);
    }
  }
  void prepare_more(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    if (event.event_class() == static_cast<std::uint8_t>(EventClass::reply)) {
      walker_.prefetch_steps(cursors_[node]);
    } else if (event.event_class() == static_cast<std::uint8_t>(EventClass::memory) &&
               interconnect_of(node).prepare_more(port_of(node))) {
      prepare_reply(node);
      walker_.prefetch_steps(cursors_[node]);
    }
  }

  void finish() override {
    for (cost::NodeStatistics& node : statistics_) {
      cost::add_counted_time(walker_.ticks(), node.steps, node.references.all_hits(), node.time);
      node.time[static_cast<std::size_t>(cost::Activity::idle)] = end_ - node.finish;
    }
    Base::watch_idle();
    if (input_.own_reads) {
      count_own_reads();
    }
  }

  walk::SecondLevelResult second_level() const override { return walker_.behind().second_level().result(); }

  walk::CacheCountResult cache_counts() const override {
    if constexpr (walk::are_counted<Caches>) {
      return walker_.counts();
    } else {
      return {};
    }
  }

  std::size_t bytes_per_node() const override { return Base::common_bytes(); }

 private:
  // Prefetches what the end of a read changes beside the first cache line of the cursor.
  void prepare_reply(std::uint32_t node) const {
    const cost::NodeStatistics& statistics = statistics_[node];
    sim::prefetch_line(&statistics.time[static_cast<std::size_t>(cost::Activity::interconnect_wait)]);
    sim::prefetch_line(&statistics.references.misses);
    walker_.prefetch(cursors_[node], statistics);
  }

  void count_own_reads() {
    for (std::uint32_t cluster = 0; cluster < input_.config.clusters; ++cluster) {
      const std::uint32_t first = cluster * input_.config.nodes;
      std::int64_t reads = 0;
      for (std::uint32_t node = first; node < first + input_.config.nodes; ++node) {
        reads += statistics_[node].references.all_misses();
      }
      interconnect_of(first).count_reads(reads, walker_.behind().own_read_bytes(cluster));
    }
  }

  static bool for_pixel(const walk::Cursor& /*cursor*/) { return true; }

  void begin_packet(std::uint32_t node, walk::Cursor& cursor) requires requires(Walker walker) {
    walker.begin_packet(node, cursor, statistics_[node]);
  }
  { walker_.begin_packet(node, cursor, statistics_[node]); }
  void begin_pixel(walk::Cursor& cursor) const { walker_.begin_pixel(cursor); }

  // Takes the node's caches through the packets left out before its next one.
  void warm_up(std::uint32_t node, std::uint64_t packet) {
    const std::uint64_t next = input_.sample->chosen()[packet];
    input_.sample->for_each_warmed(begun_[node], next, begun_.size(), [&](std::uint64_t left_out) {
      walker_.warm_up(node, (*input_.all_packets)[left_out]);
    });
    begun_[node] = next + 1;
  }

  walk::Stop advance(std::uint32_t node, walk::Cursor& cursor, cost::NodeStatistics& statistics) {
    if constexpr (Walker::steps_singly) {
      if (input_.step_by_step) {
        return walker_.template advance<false>(node, cursor, statistics);
      }
    }
    return walker_.template advance<true>(node, cursor, statistics);
  }

  // Lets a node work until it needs something shared.
  void run(std::uint32_t node) {
    walk::Cursor& cursor = cursors_[node];
    cost::NodeStatistics& statistics = statistics_[node];
    const sim::Ticks from = cursor.time;
    const walk::Stop stop = advance(node, cursor, statistics);
    if (stop == walk::Stop::end) {
      walker_.finish_pixel(node, cursor, statistics);
    }
    watch(node, walk::NodeState::working, from);
    static constexpr std::array classes = {EventClass::step, EventClass::read, EventClass::write};
    post(classes[static_cast<std::size_t>(stop)], cursor.time, node);
  }

  void read(std::uint32_t node) {
    const walk::Cursor& cursor = cursors_[node];
    Base::read_memory(node, {port_of(node), walker_.missed_address(cursor), walker_.missed_bytes(cursor)});
  }

  // Joined with the interconnect's code where that is known: see Bus::send_data.
  [[gnu::always_inline]] void read_done(std::uint32_t node, const memory::Service& service) {
    spend(node, service);
    watch_read(node, service);
    walk::Cursor& cursor = cursors_[node];
    cursor.time = service.done;
    walker_.note_wait(cursor, service);
    walker_.pass(cursor);
    run(node);
  }

  Walker walker_;
  std::vector<std::uint64_t> begun_;  // with a sample: one past the packet that each node has begun last
};

}  // namespace marti::processors::node
