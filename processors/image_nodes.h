// Nodes of the image scheme: each takes a packet of neighbouring pixels and traces it whole.
#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <utility>

#include "processors/log_walker.h"
#include "processors/node_array.h"
#include "processors/node_caches.h"
#include "processors/step_time.h"
#include "sim/large_pages.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h. See node_array.h for what the members do.
template <class Caches>
class ImageNodes final : public NodeArray {
 public:
  ImageNodes(const ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : input_(input),
        engine_(engine),
        host_(host),
        walker_(input, std::move(caches)),
        cursors_(input.config.all_nodes()),
        statistics_(input.config.all_nodes()),
        writes_(std::size_t{input.config.all_nodes()} * input.config.write_buffer) {
    clients_.reserve(input.config.clusters);
    for (std::uint32_t cluster = 0; cluster < input.config.clusters; ++cluster) {
      clients_.emplace_back(*this, cluster * input.config.nodes);
    }
  }

  void connect(std::vector<memory::Interconnect*> interconnects) override {
    interconnects_ = std::move(interconnects);
  }
  memory::InterconnectClient& client(std::uint32_t cluster) override { return clients_[cluster]; }

  void start(std::uint64_t seed) override {
    std::vector<std::uint32_t> order(cursors_.size());
    std::iota(order.begin(), order.end(), 0U);
    if (seed != 0) {
      std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
    }
    for (const std::uint32_t node : order) {
      post(EventClass::dispatch, 0, node);
    }
  }

  void handle(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        run(node);
        break;
      case EventClass::dispatch:
        dispatch(node);
        break;
      case EventClass::reply:
        interconnect_of(node).reply(port_of(node));
        break;
      case EventClass::read:
        read(node);
        break;
      case EventClass::write:
        write(node);
        break;
    }
  }

  void prepare(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    prefetch(cursors_[node]);
    prefetch(statistics_[node]);
  }

  sim::Ticks end() const override { return end_; }

  void finish() override {
    for (NodeStatistics& node : statistics_) {
      add_counted_time(walker_.ticks(), node.steps, node.references.all_hits(), node.time);
      node.time[static_cast<std::size_t>(Activity::idle)] = end_ - node.finish;
    }
  }

  std::vector<NodeStatistics> statistics() const override { return {statistics_.begin(), statistics_.end()}; }

  std::size_t bytes_per_node() const override {
    return sizeof(Cursor) + sizeof(NodeStatistics) + sizeof(sim::Event) +
           input_.config.write_buffer * sizeof(sim::Ticks);
  }

 private:
  // One cluster's ports, with port numbers turned into node numbers.
  class Client final : public memory::InterconnectClient {
   public:
    Client(ImageNodes& nodes, std::uint32_t first) : nodes_(nodes), first_(first) {}
    void read_done(std::uint32_t port, const memory::Service& service) override {
      nodes_.read_done(first_ + port, service);
    }
    void write_done(std::uint32_t port, sim::Ticks done) override { nodes_.write_done(first_ + port, done); }

   private:
    ImageNodes& nodes_;
    std::uint32_t first_;
  };

  template <class T>
  static void prefetch(const T& object) {
    const char* const bytes = reinterpret_cast<const char*>(&object);
    for (std::size_t at = 0; at < sizeof(T); at += 64) {
      __builtin_prefetch(bytes + at, 1);
    }
  }

  // One cluster is the common case, and a division at every event shows.
  std::uint32_t cluster_of(std::uint32_t node) const {
    return interconnects_.size() == 1 ? 0 : node / input_.config.nodes;
  }
  std::uint32_t port_of(std::uint32_t node) const { return node - cluster_of(node) * input_.config.nodes; }
  memory::Interconnect& interconnect_of(std::uint32_t node) { return *interconnects_[cluster_of(node)]; }
  void post(EventClass event_class, sim::Ticks time, std::uint32_t node) {
    engine_.post(sim::Event::make(time, static_cast<std::uint8_t>(event_class), node));
  }
  void spend(std::uint32_t node, Activity activity, sim::Ticks time) {
    statistics_[node].time[static_cast<std::size_t>(activity)] += time;
  }

  // Gives the node its next packet, or ends it.
  void dispatch(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    const std::optional<Grant> grant = host_.next(node, cursor.time);
    if (!grant) {
      statistics_[node].finish = cursor.time;
      end_ = std::max(end_, cursor.time);
      return;
    }
    spend(node, Activity::dispatch_wait, grant->start - cursor.time);
    ++statistics_[node].packets;
    cursor.time = grant->start;
    cursor.packet = input_.packets[grant->packet];
    cursor.y = cursor.packet.y0;
    cursor.x = cursor.packet.x0;
    begin_pixel(cursor);
    run(node);
  }

  void begin_pixel(Cursor& cursor) {
    const std::span<const std::uint32_t> words = input_.log.pixel(cursor.x, cursor.y);
    cursor.word = words.data();
    cursor.word_end = words.data() + words.size();
  }

  // Lets a node work until it needs something shared.
  void run(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    NodeStatistics& statistics = statistics_[node];
    const Stop stop = input_.step_by_step ? walker_.template advance<false>(node, cursor, statistics)
                                          : walker_.template advance<true>(node, cursor, statistics);
    constexpr std::array classes = {EventClass::step, EventClass::read, EventClass::write};
    post(classes[static_cast<std::size_t>(stop)], cursor.time, node);
  }

  void read(std::uint32_t node) {
    const Cursor& cursor = cursors_[node];
    interconnect_of(node).read({port_of(node), walker_.missed_address(cursor), walker_.missed_bytes(cursor)});
  }

  void read_done(std::uint32_t node, const memory::Service& service) {
    spend(node, Activity::interconnect_wait, service.wait_interconnect);
    spend(node, Activity::transfer, service.transfer);
    spend(node, Activity::bank_wait, service.wait_bank);
    spend(node, Activity::bank_access, service.bank);
    Cursor& cursor = cursors_[node];
    cursor.time = service.done;
    walker_.pass(cursor);
    run(node);
  }

  // The oldest write still in the buffer decides whether there is room; a full buffer stalls the node
  // until that write is done, and the write is tried again then.
  void write(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    const sim::Ticks room_at = writes_[std::size_t{node} * input_.config.write_buffer + cursor.writes];
    if (room_at > cursor.time) {
      spend(node, Activity::queue_full_wait, room_at - cursor.time);
      cursor.time = room_at;
      post(EventClass::write, room_at, node);
      return;
    }
    ++statistics_[node].writes;
    const std::uint64_t pixel = std::uint64_t{cursor.y} * input_.log.width + cursor.x;
    interconnect_of(node).write({port_of(node), input_.layout.address(memory::RecordKind::pixel, pixel),
                                 input_.layout.record_bytes(memory::RecordKind::pixel)});
    next_pixel(node);
  }

  void write_done(std::uint32_t node, sim::Ticks done) {
    Cursor& cursor = cursors_[node];
    const std::uint32_t depth = input_.config.write_buffer;
    writes_[std::size_t{node} * depth + cursor.writes] = done;
    cursor.writes = cursor.writes + 1 == depth ? 0 : cursor.writes + 1;
    end_ = std::max(end_, done);
  }

  void next_pixel(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    if (++cursor.x == cursor.packet.x1) {
      cursor.x = cursor.packet.x0;
      if (++cursor.y == cursor.packet.y1) {
        post(EventClass::dispatch, cursor.time, node);
        return;
      }
    }
    begin_pixel(cursor);
    run(node);
  }

  ReplayInput input_;
  sim::Engine& engine_;
  Host& host_;
  LogWalker<Caches> walker_;
  sim::LargeVector<Cursor> cursors_;
  sim::LargeVector<NodeStatistics> statistics_;
  sim::LargeVector<sim::Ticks> writes_;  // when each entry of each node's write buffer is free
  std::vector<Client> clients_;
  std::vector<memory::Interconnect*> interconnects_;
  sim::Ticks end_ = 0;
};

}  // namespace marti::processors
