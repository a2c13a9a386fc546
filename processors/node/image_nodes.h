// Nodes of the image scheme: each takes a packet of neighbouring pixels and traces it whole.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "processors/cost/step_time.h"
#include "processors/node/packet_nodes.h"
#include "processors/node/work_ahead.h"
#include "processors/walk/log_walker.h"
#include "processors/walk/node_caches.h"
#include "sim/prefetch.h"

namespace marti::processors::node {

/// `Caches` is one of node_caches.h, `Walker` is LogWalker or StrippedWalker with them. The members are
/// described in node_array.h.
template <class Caches, class Walker = walk::LogWalker<Caches>>
class ImageNodes final : public PacketNodes<ImageNodes<Caches, Walker>, walk::Cursor>, private NodeWork {
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
        begun_(input.sample == nullptr ? 0 : input.config.all_nodes()) {
    if (input.helpers != 0) {
      ahead_.emplace(input.helpers, input.config.all_nodes(), static_cast<NodeWork&>(*this));
    }
  }

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

  void run_all(sim::Engine& engine) override {
    if (!ahead_) {
      engine.run_all(*this);
      return;
    }
    const WorkAhead::Team team(*ahead_);
    engine.run_all(*this);
  }
  void run_before(sim::Engine& engine, sim::Ticks end) override { engine.run_before(*this, end); }
  void grant(std::uint32_t node, const std::optional<Grant>& grant) override { Base::begin(node, grant); }

  void prepare(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    interconnect_of(node).prepare(port_of(node));
    if (ahead_) {
      ahead_->prepare(node);
      // While a node reads, its own data stay in the caches of who works for it.
      if (event.event_class() == static_cast<std::uint8_t>(EventClass::write) ||
          event.event_class() == static_cast<std::uint8_t>(EventClass::dispatch)) {
        prepare_ahead(node);
      }
      return;
    }
    sim::prefetch_line(&cursors_[node]);
    if (event.event_class() == static_cast<std::uint8_t>(EventClass::reply)) {
      prepare_reply(node);
    }
  }
  void prepare_more(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    if (ahead_) {
      if (event.event_class() == static_cast<std::uint8_t>(EventClass::memory)) {
        (void)interconnect_of(node).prepare_more(port_of(node));
      }
      return;
    }
    if (event.event_class() == static_cast<std::uint8_t>(EventClass::reply)) {
      walker_.prefetch_steps(cursors_[node]);
    } else if (event.event_class() == static_cast<std::uint8_t>(EventClass::memory) &&
               interconnect_of(node).prepare_more(port_of(node))) {
      prepare_reply(node);
      walker_.prefetch_steps(cursors_[node]);
    }
  }

  void finish() override {
    for (std::uint32_t node = 0; ahead_ && node < statistics_.size(); ++node) {
      spend(node, ahead_->of(node).reads);
    }
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
    const sim::Ticks from = cursors_[node].time;
    const walk::Stop stop = work(node);
    watch(node, walk::NodeState::working, from);
    if (ahead_) {
      tell(node, stop, ahead_->of(node));
    }
    go_on(node, stop, cursors_[node].time);
  }
  walk::Stop work(std::uint32_t node) {
    walk::Cursor& cursor = cursors_[node];
    const walk::Stop stop = advance(node, cursor, statistics_[node]);
    if (stop == walk::Stop::end) {
      walker_.finish_pixel(node, cursor, statistics_[node]);
    }
    return stop;
  }
  void go_on(std::uint32_t node, walk::Stop stop, sim::Ticks time) {
    static constexpr std::array classes = {EventClass::step, EventClass::read, EventClass::write};
    post(classes[static_cast<std::size_t>(stop)], time, node);
  }

  void work_ahead(std::uint32_t node, Ahead& ahead) override {
    walk::Cursor& cursor = cursors_[node];
    cursor.time = 0;
    walker_.pass(cursor);
    tell(node, work(node), ahead);
  }
  void tell(std::uint32_t node, walk::Stop stop, Ahead& ahead) const {
    const walk::Cursor& cursor = cursors_[node];
    ahead.time = cursor.time;
    ahead.stop = stop;
    if (stop == walk::Stop::miss) {
      ahead.address = walker_.missed_address(cursor);
      ahead.bytes = walker_.missed_bytes(cursor);
    }
  }
  void prepare_ahead(std::uint32_t node) const override {
    sim::prefetch_line(&cursors_[node]);
    sim::prefetch_line(&statistics_[node].references.misses);
    walker_.prefetch(cursors_[node], statistics_[node]);
  }

  void read(std::uint32_t node) {
    if (ahead_) {
      const Ahead& ahead = ahead_->of(node);
      const memory::Transaction missed = {port_of(node), ahead.address, ahead.bytes};
      ahead_->begin(node);
      Base::read_memory(node, missed);
      return;
    }
    const walk::Cursor& cursor = cursors_[node];
    Base::read_memory(node, {port_of(node), walker_.missed_address(cursor), walker_.missed_bytes(cursor)});
  }

  // Joined with the interconnect's code where that is known: see Bus::send_data.
  [[gnu::always_inline]] void read_done(std::uint32_t node, const memory::Service& service) {
    if (ahead_) {
      read_ahead_done(node, service);
      return;
    }
    spend(node, service);
    watch_read(node, service);
    walk::Cursor& cursor = cursors_[node];
    cursor.time = service.done;
    walker_.note_wait(cursor, service);
    walker_.pass(cursor);
    run(node);
  }
  void read_ahead_done(std::uint32_t node, const memory::Service& service) {
    ahead_->finish(node);
    Ahead& ahead = ahead_->of(node);
    ahead.reads.wait_interconnect += service.wait_interconnect;
    ahead.reads.transfer += service.transfer;
    ahead.reads.wait_bank += service.wait_bank;
    ahead.reads.bank += service.bank;
    const sim::Ticks time = sim::add_ticks(service.done, ahead.time);
    if (ahead.stop != walk::Stop::miss) {
      cursors_[node].time = time;
    }
    go_on(node, ahead.stop, time);
  }

  Walker walker_;
  std::vector<std::uint64_t> begun_;  // with a sample: one past the packet that each node has begun last
  std::optional<WorkAhead> ahead_;
};

}  // namespace marti::processors::node
