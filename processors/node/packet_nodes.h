// What the nodes of every replay of the image scheme have in common: packets from the host, pixels one after
// the other, posted writes, and the way to their cluster's interconnect.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/node/cluster_interconnects.h"
#include "processors/node/node_array.h"
#include "processors/walk/cause_observer.h"
#include "processors/walk/observer.h"
#include "sim/large_pages.h"

namespace marti::processors::node {

/// `Derived` has run(node), which lets a node work until it needs something shared; read_done(node, service);
/// and for_pixel(cursor), whether the node's present work is for the pixel at its cursor. `Cursor` has time,
/// word, word_end, writes, x, y and packet. Where a node has several ports (MachineConfig::ports_of_node),
/// read_done gets the port instead of the node, numbered through all clusters. Of a Derived that hands out
/// packets and takes its steps itself (SIMT nodes) only read_done is used, and room_is_known(node, time)
/// after expect_room(); its Cursor has only `writes`.
template <class Derived, class Cursor>
class PacketNodes : public NodeArray {
 public:
  void connect(std::vector<memory::Interconnect*> interconnects) override {
    interconnects_.connect(std::move(interconnects));
  }
  memory::InterconnectClient& client(std::uint32_t cluster) override { return clients_[cluster]; }
  sim::Ticks end() const override { return end_; }
  void end_not_before(sim::Ticks end) override { end_ = std::max(end_, end); }
  std::vector<cost::NodeStatistics> statistics() const override {
    return {statistics_.begin(), statistics_.end()};
  }
  std::vector<walk::PacketFigures> packet_figures() const override { return meter_.figures(); }

 protected:
  PacketNodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host)
      : input_(input),
        engine_(engine),
        host_(host),
        cursors_(input.config.all_nodes()),
        statistics_(input.config.all_nodes()),
        ports_(input.config.ports_of_node()),
        one_cluster_(input.config.clusters == 1),
        meter_(input.sample == nullptr ? 0 : input.packets.size(), input.config.all_nodes()),
        writes_(std::size_t{input.config.all_nodes()} * input.config.write_buffer),
        late_(machine::writes_done_later(input.config) ? input.config.all_nodes() : 0) {
    clients_.reserve(input.config.clusters);
    for (std::uint32_t cluster = 0; cluster < input.config.clusters; ++cluster) {
      clients_.emplace_back(derived(), cluster * input.config.nodes * ports_, ports_);
    }
  }

  // The numbers of all nodes, in an order drawn from `seed` (0: ascending).
  [[nodiscard]] std::vector<std::uint32_t> first_order(std::uint64_t seed) const {
    return order_drawn_from(seed, cursors_.size());
  }

  // One cluster is the common case, and a division at every event would cost measurable time.
  std::uint32_t cluster_of(std::uint32_t node) const { return one_cluster_ ? 0 : node / input_.config.nodes; }
  // The first of the node's ports, which also posts its writes.
  std::uint32_t port_of(std::uint32_t node) const {
    return (node - cluster_of(node) * input_.config.nodes) * ports_;
  }
  memory::Interconnect& interconnect_of(std::uint32_t node) { return interconnects_[cluster_of(node)]; }
  // Reads through one of the node's ports.
  void read_memory(std::uint32_t node, const memory::Transaction& transaction) {
    const std::uint32_t cluster = cluster_of(node);
    interconnects_.read(cluster, clients_[cluster], transaction);
  }
  void reply(std::uint32_t node, std::uint32_t port) {
    const std::uint32_t cluster = cluster_of(node);
    interconnects_.reply(cluster, clients_[cluster], port);
  }
  [[gnu::always_inline]] void post(EventClass event_class, sim::Ticks time, std::uint32_t node) {
    engine_.post(sim::Event::make(time, static_cast<std::uint8_t>(event_class), node));
  }
  void spend(std::uint32_t node, cost::Activity activity, sim::Ticks time) {
    statistics_[node].time[static_cast<std::size_t>(activity)] += time;
  }
  void spend(std::uint32_t node, const memory::Service& service) {
    cost::add_service(statistics_[node].time, service);
  }
  // Tells the observer, if there is one, that the node was in `state` from `from` to its present time.
  void watch(std::uint32_t node, walk::NodeState state, sim::Ticks from, bool for_pixel = true) {
    if (input_.observer != nullptr) {
      if (state == walk::NodeState::working) {
        watch_work(node, for_pixel);
      }
      if (from != cursors_[node].time) {
        input_.observer->spent(node, state, from, cursors_[node].time,
                               for_pixel ? place_of(node) : walk::PixelPlace{});
      }
    }
  }
  // Tells who asks for causes how far the node has come. Not inlined: few replays need it, and the functions
  // that call it are those in which all replays spend their time.
  [[gnu::noinline]] void watch_work(std::uint32_t node, bool for_pixel) {
    if (input_.causes == nullptr) {
      return;
    }
    walk::LogPlace place;
    if (for_pixel) {
      const Cursor& cursor = cursors_[node];
      place.pixel = cursor.y * input_.log.width + cursor.x;
      place.word = static_cast<std::uint32_t>(cursor.word - input_.log.pixel(cursor.x, cursor.y).data());
    }
    input_.causes->worked(node, statistics_[node], place);
  }
  // Tells the observer of a read that is done and was asked for at the node's present time.
  void watch_read(std::uint32_t node, const memory::Service& service, bool for_pixel = true) {
    if (input_.observer != nullptr) {
      walk::spent_reading(*input_.observer, node, service, cursors_[node].time,
                          for_pixel ? place_of(node) : walk::PixelPlace{});
    }
  }
  // Tells the observer that the node's misses since the last call were for `pixel`.
  void watch_misses(std::uint32_t node, walk::PixelPlace pixel) {
    if (input_.observer == nullptr) {
      return;
    }
    seen_misses_.resize(cursors_.size());
    const std::int64_t all = statistics_[node].references.all_misses();
    if (all != seen_misses_[node]) {
      input_.observer->missed(node, all - seen_misses_[node], pixel);
      seen_misses_[node] = all;
    }
  }
  void watch_idle() {
    for (std::uint32_t node = 0; input_.observer != nullptr && node < cursors_.size(); ++node) {
      if (statistics_[node].finish != end_) {
        input_.observer->spent(node, walk::NodeState::idle, statistics_[node].finish, end_, {});
      }
    }
  }
  /// Host bytes that every kind of node takes: the cursor, statistics, an event, and the write buffer.
  [[nodiscard]] std::size_t common_bytes() const {
    return sizeof(Cursor) + sizeof(cost::NodeStatistics) + sim::EventQueue::bytes_an_event +
           input_.config.write_buffer * sizeof(sim::Ticks) + (late_.empty() ? 0 : sizeof(LateWrites));
  }

  [[nodiscard]] walk::PixelPlace place_of(std::uint32_t node) const {
    return {cursors_[node].x, cursors_[node].y};
  }

  // Puts the cursor before the first step of its pixel. Derived may replace it.
  void begin_pixel(Cursor& cursor) const {
    const std::span<const std::uint32_t> words = input_.log.pixel(cursor.x, cursor.y);
    cursor.word = words.data();
    cursor.word_end = words.data() + words.size();
  }

  // Gives the node its next packet; when none is left, the node is done.
  void dispatch(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    watch_misses(node, {});  // misses before the frame belong to no pixel
    if (meter_.on()) {
      meter_.end(node, cursor.time, statistics_[node]);
    }
    const std::uint32_t first_node = input_.part == nullptr ? 0 : input_.part->first_node;
    if (input_.part != nullptr && input_.part->asks_later) {
      input_.part->requests.push_back({engine_.turn(), node});
      return;
    }
    begin(node, host_.next(first_node + node, cursor.time));
  }

  // Begins the packet that the node was given, if one was left.
  void begin(std::uint32_t node, const std::optional<Grant>& grant) {
    Cursor& cursor = cursors_[node];
    if (!grant) {
      statistics_[node].finish = cursor.time;
      end_ = std::max(end_, cursor.time);
      return;
    }
    spend(node, cost::Activity::dispatch_wait, grant->start - cursor.time);
    ++statistics_[node].packets;
    const sim::Ticks asked = std::exchange(cursor.time, grant->start);
    if (input_.observer != nullptr) {
      if (input_.causes != nullptr) {
        input_.causes->granted(node, 0, asked, grant->start);
      }
      watch(node, walk::NodeState::dispatch_wait, asked, false);
      input_.observer->began_packet(node, grant->packet, grant->start);
    }
    if (meter_.on()) {
      meter_.begin(node, grant->packet, grant->start, statistics_[node]);
      if constexpr (requires { derived().warm_up(node, grant->packet); }) {
        derived().warm_up(node, grant->packet);
      }
    }
    cursor.packet = input_.packets[grant->packet];
    cursor.y = cursor.packet.y0;
    cursor.x = cursor.packet.x0;
    if constexpr (requires { derived().begin_packet(node, cursor); }) {
      derived().begin_packet(node, cursor);
    }
    derived().begin_pixel(cursor);
    derived().run(node);
  }

  // Whether the write buffer has room, which depends on its oldest write. If not, the node stalls until that
  // write is done, and then tries again.
  bool has_room(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    const sim::Ticks room_at = writes_[std::size_t{node} * input_.config.write_buffer + cursor.writes];
    if (room_at <= cursor.time) {
      return true;
    }
    if (room_at == not_known) {
      late_[node].stalled = true;
    } else {
      wait_for_room(node, room_at);
    }
    return false;
  }

  // When the write buffer has room for one more write, after `queued` writes that are posted at this instant;
  // not_known while that is not known, or when these take all of it.
  [[nodiscard]] sim::Ticks room_at(std::uint32_t node, std::size_t queued) const {
    const std::size_t depth = input_.config.write_buffer;
    return queued >= depth ? not_known : writes_[node * depth + (cursors_[node].writes + queued) % depth];
  }
  // Has room_is_known(node, time) called when the end of the node's oldest write becomes known.
  void expect_room(std::uint32_t node) { late_[node].stalled = true; }

  // Posts a write for which there is room.
  void make_write(std::uint32_t node, memory::Address address, std::uint32_t bytes) {
    if (!late_.empty()) {
      enter_write(node, not_known);
      ++late_writes_;
    }
    const std::uint32_t cluster = cluster_of(node);
    interconnects_.write(cluster, clients_[cluster], {port_of(node), address, bytes});
  }
  // Whether the end of every write posted so far is known.
  [[nodiscard]] bool all_writes_known() const { return late_writes_ == 0; }
  // Called when the last end of a write becomes known. Derived may replace it.
  void writes_are_known() {}

  // Posts the finished pixel, unless the host collects it, and continues with the next one.
  void write_pixel(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    if (input_.config.pixels == machine::Pixels::written) {
      ++statistics_[node].writes;
      const std::uint64_t pixel = std::uint64_t{cursor.y} * input_.log.width + cursor.x;
      make_write(node, input_.layout.address(memory::RecordKind::pixel, pixel),
                 input_.layout.record_bytes(memory::RecordKind::pixel));
    }
    watch_misses(node, place_of(node));
    if (++cursor.x == cursor.packet.x1) {
      cursor.x = cursor.packet.x0;
      if (++cursor.y == cursor.packet.y1) {
        post(EventClass::dispatch, cursor.time, node);
        return;
      }
    }
    derived().begin_pixel(cursor);
    derived().run(node);
  }

  static constexpr sim::Ticks not_known = std::numeric_limits<sim::Ticks>::max();

  walk::ReplayInput input_;
  sim::Engine& engine_;
  Host& host_;
  sim::LargeVector<Cursor> cursors_;
  sim::LargeVector<cost::NodeStatistics> statistics_;
  sim::Ticks end_ = 0;
  sim::Ticks last_write_done_ = 0;  // of the write posted last
  std::uint32_t ports_;             // of each node
  bool one_cluster_;

 private:
  // One cluster's ports, with port numbers turned into node numbers.
  class Client final : public memory::InterconnectClient {
   public:
    Client(Derived& nodes, std::uint32_t first, std::uint32_t ports)
        : nodes_(nodes), first_(first), ports_(ports) {}
    [[gnu::always_inline]] void read_done(std::uint32_t port, const memory::Service& service) override {
      nodes_.read_done(first_ + port, service);
    }
    void write_done(std::uint32_t port, sim::Ticks done) override {
      const std::uint32_t all = first_ + port;
      static_cast<PacketNodes&>(nodes_).write_done(ports_ == 1 ? all : all / ports_, done);
    }

   private:
    Derived& nodes_;
    std::uint32_t first_;
    std::uint32_t ports_;
  };

  Derived& derived() { return static_cast<Derived&>(*this); }

  void wait_for_room(std::uint32_t node, sim::Ticks room_at) {
    Cursor& cursor = cursors_[node];
    spend(node, cost::Activity::queue_full_wait, room_at - cursor.time);
    const sim::Ticks from = std::exchange(cursor.time, room_at);
    watch(node, walk::NodeState::queue_full_wait, from, derived().for_pixel(cursor));
    post(EventClass::write, room_at, node);
  }

  void enter_write(std::uint32_t node, sim::Ticks done) {
    Cursor& cursor = cursors_[node];
    const std::uint32_t depth = input_.config.write_buffer;
    writes_[std::size_t{node} * depth + cursor.writes] = done;
    cursor.writes = cursor.writes + 1 == depth ? 0 : cursor.writes + 1;
  }

  // Called when the end of the node's oldest write not reported yet is known: during the write, during a
  // transaction of another node, or in an event of the memory.
  void write_done(std::uint32_t node, sim::Ticks done) {
    last_write_done_ = done;
    end_ = std::max(end_, done);
    if (late_.empty()) {
      enter_write(node, done);
      return;
    }
    LateWrites& late = late_[node];
    const std::uint32_t depth = input_.config.write_buffer;
    writes_[std::size_t{node} * depth + late.oldest] = done;
    late.oldest = late.oldest + 1 == depth ? 0 : late.oldest + 1;
    if (std::exchange(late.stalled, false)) {
      if constexpr (requires { derived().room_is_known(node, done); }) {
        derived().room_is_known(node, done);
      } else {
        wait_for_room(node, done);
      }
    }
    if (--late_writes_ == 0) {
      derived().writes_are_known();
    }
  }

  // The state of a node whose writes may end at a time that is not known when they are posted.
  struct LateWrites {
    std::uint32_t oldest = 0;  // the entry of the write buffer whose end becomes known next
    bool stalled = false;      // the node waits for the end of that entry
  };

  walk::PacketMeter meter_;              // on with a sample of packets
  sim::LargeVector<sim::Ticks> writes_;  // when each entry of each node's write buffer is free
  sim::LargeVector<LateWrites> late_;    // empty where the end of a write is known at once
  std::int64_t late_writes_ = 0;         // number of writes whose end is not known
  std::vector<Client> clients_;
  ClusterInterconnects interconnects_;
  std::vector<std::int64_t> seen_misses_;  // already reported to the observer; empty without one
};

}  // namespace marti::processors::node
