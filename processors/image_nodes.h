// Nodes of the image scheme: each takes a packet of neighbouring pixels and traces it whole.
#pragma once

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>
#include <utility>

#include "processors/node_array.h"
#include "processors/node_caches.h"
#include "processors/step_time.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h. See node_array.h for what the members do.
template <class Caches>
class ImageNodes final : public NodeArray {
 public:
  ImageNodes(const ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : input_(input),
        engine_(engine),
        host_(host),
        caches_(std::move(caches)),
        topology_(input.log.topology.nodes.data()),
        entries_(input.log.topology.entries.data()),
        rank_(input.node_rank.empty() ? nullptr : input.node_rank.data()),
        node_bytes_(input.layout.record_bytes(memory::RecordKind::node)),
        entry_bytes_(input.layout.record_bytes(memory::RecordKind::list)),
        primitive_bytes_(input.layout.record_bytes(memory::RecordKind::primitive)),
        ticks_(step_ticks(input.config)),
        local_access_(input.config.local.clock.cycles(input.config.local.access_cycles)),
        local_beat_(input.config.local.clock.cycles(input.config.local.cycles_per_beat)),
        run_ahead_(!input.step_by_step),
        local_database_(input.config.placement == Placement::replicated),
        cursors_(input.config.all_nodes()),
        statistics_(input.config.all_nodes()),
        writes_(std::size_t{input.config.all_nodes()} * input.config.write_buffer) {
    const std::uint32_t unit =
        Caches::present ? input.config.cache.cache.line : input.config.banks.interleave;
    unit_shift_ = static_cast<unsigned>(std::countr_zero(unit));
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

  sim::Ticks end() const override { return end_; }

  void finish() override {
    for (NodeStatistics& node : statistics_) {
      add_counted_time(ticks_, node.steps, node.references.all_hits(), node.time);
      node.time[static_cast<std::size_t>(Activity::idle)] = end_ - node.finish;
    }
  }

  const std::vector<NodeStatistics>& statistics() const override { return statistics_; }

  std::size_t bytes_per_node() const override {
    return sizeof(Cursor) + sizeof(NodeStatistics) + sizeof(sim::Event) +
           input_.config.write_buffer * sizeof(sim::Ticks);
  }

 private:
  // Where a node is in its packet: the pixel, the word of the pixel's log, the object of the current
  // leaf's list and the byte of the current record.
  struct Cursor {
    sim::Ticks time = 0;
    memory::Address at = 0;   // next byte of the current record
    memory::Address end = 0;  // one past its last byte
    const std::uint32_t* word = nullptr;
    const std::uint32_t* word_end = nullptr;
    const std::uint32_t* entry = nullptr;
    const std::uint32_t* entry_end = nullptr;
    Packet packet;
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    std::uint32_t list_count = 0;  // entries of the current leaf's list, while its read is still to come
    std::uint32_t writes = 0;      // pixel writes issued, modulo the write buffer
    memory::RecordKind kind = memory::RecordKind::node;
  };

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

  std::uint32_t port_of(std::uint32_t node) const { return node % input_.config.nodes; }
  memory::Interconnect& interconnect_of(std::uint32_t node) {
    return *interconnects_[node / input_.config.nodes];
  }
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

  // Runs a node ahead until it needs something shared. It works on a copy of the cursor, which the
  // compiler keeps in registers, and puts it back when it stops.
  void run(std::uint32_t node) {
    Cursor cursor = cursors_[node];
    const EventClass stop = run_ahead_ ? advance<true>(node, cursor, statistics_[node])
                                       : advance<false>(node, cursor, statistics_[node]);
    cursors_[node] = cursor;
    post(stop, cursor.time, node);
  }

  // The class of the event at which it stopped.
  template <bool RunAhead>
  EventClass advance(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics) {
    EventClass stop = EventClass::step;
    if (!touch<RunAhead>(node, cursor, statistics, cursor.kind, stop) ||
        !finish_leaf<RunAhead>(node, cursor, statistics, stop)) {
      return stop;
    }
    while (cursor.word != cursor.word_end) {
      if (!take_step<RunAhead>(node, cursor, statistics, stop)) {
        return stop;
      }
    }
    ++statistics.steps.pixels;
    cursor.time = sim::add_ticks(cursor.time, ticks_.pixel);
    return EventClass::write;
  }

  // Makes record `index` the current one and reads it; `bytes` may span several records of an array.
  template <bool RunAhead>
  [[gnu::always_inline]] bool refer(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics,
                                    memory::RecordKind kind, std::uint64_t index, std::uint64_t bytes,
                                    EventClass& stop) {
    cursor.at = input_.layout.address(kind, index);
    cursor.end = cursor.at + bytes;
    return touch<RunAhead>(node, cursor, statistics, kind, stop);
  }

  // Reads what is left of the current record, line by line. False when the node has to stop at `stop`.
  template <bool RunAhead>
  [[gnu::always_inline]] bool touch(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics,
                                    memory::RecordKind kind, EventClass& stop) {
    std::int64_t hits = 0;
    const auto settle = [&] {
      statistics.references.hits[static_cast<std::size_t>(kind)] += hits;
      cursor.time = sim::add_ticks(cursor.time, sim::multiply_ticks(ticks_.hit, hits));
      cursor.kind = kind;
    };
    while (cursor.at < cursor.end) {
      const memory::Address unit = cursor.at >> unit_shift_;
      if (caches_.access(node, kind, static_cast<std::uint32_t>(unit))) [[likely]] {
        ++hits;
        cursor.at = (unit + 1) << unit_shift_;
      } else {
        ++statistics.references.misses[static_cast<std::size_t>(kind)];
        if (!local_database_) {
          settle();
          stop = EventClass::read;
          return false;
        }
        read_local(cursor, statistics);
      }
      if constexpr (!RunAhead) {
        settle();
        return false;
      }
    }
    settle();
    return true;
  }

  // What is left of the current leaf: reading its list, then testing its objects one by one.
  template <bool RunAhead>
  [[gnu::always_inline]] bool finish_leaf(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics,
                                          EventClass& stop) {
    if (cursor.list_count != 0) {
      const std::uint64_t bytes = std::uint64_t{cursor.list_count} * entry_bytes_;
      cursor.list_count = 0;
      const auto first = static_cast<std::uint64_t>(cursor.entry - entries_);
      if (!refer<RunAhead>(node, cursor, statistics, memory::RecordKind::list, first, bytes, stop)) {
        return false;
      }
    }
    while (cursor.entry != cursor.entry_end) {
      ++statistics.steps.tests;
      cursor.time = sim::add_ticks(cursor.time, ticks_.test);
      if (!refer<RunAhead>(node, cursor, statistics, memory::RecordKind::primitive, *cursor.entry++,
                           primitive_bytes_, stop)) {
        return false;
      }
    }
    return true;
  }

  template <bool RunAhead>
  [[gnu::always_inline]] bool refer_node(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics,
                                         std::uint32_t tree_node, EventClass& stop) {
    const std::uint32_t record = rank_ == nullptr ? tree_node : rank_[tree_node];
    return refer<RunAhead>(node, cursor, statistics, memory::RecordKind::node, record, node_bytes_, stop);
  }

  // Takes the next step of the pixel's log: its compute cycles first, then its references.
  template <bool RunAhead>
  [[gnu::always_inline]] bool take_step(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics,
                                        EventClass& stop) {
    const std::uint32_t word = *cursor.word++;
    const std::uint32_t operand = operand_of(word);
    StepCounts& steps = statistics.steps;
    switch (step_of(word)) {
      case Step::branch:
        ++steps.branches;
        cursor.time = sim::add_ticks(cursor.time, ticks_.branch);
        return refer_node<RunAhead>(node, cursor, statistics, operand, stop);
      case Step::leaf:
        return take_leaf<RunAhead>(node, cursor, statistics, operand, topology_[operand].count, stop);
      case Step::partial_leaf: {
        const std::uint32_t tests = *cursor.word++;
        return take_leaf<RunAhead>(node, cursor, statistics, operand, tests, stop);
      }
      case Step::ray:
        ++steps.rays[operand & 3U];
        cursor.time = sim::add_ticks(cursor.time, ticks_.ray[operand & 3U]);
        return true;
      case Step::shade:
        ++steps.shades;
        cursor.time = sim::add_ticks(cursor.time, ticks_.shade);
        return refer<RunAhead>(node, cursor, statistics, memory::RecordKind::material, operand,
                               input_.layout.record_bytes(memory::RecordKind::material), stop);
      case Step::light:
        ++steps.lights;
        cursor.time = sim::add_ticks(cursor.time, ticks_.light);
        return true;
      case Step::texel:
        ++steps.texels;
        cursor.time = sim::add_ticks(cursor.time, ticks_.texel);
        return refer<RunAhead>(node, cursor, statistics, memory::RecordKind::texel,
                               input_.log.texture_begin[operand] + *cursor.word++,
                               input_.layout.record_bytes(memory::RecordKind::texel), stop);
    }
    return true;
  }

  template <bool RunAhead>
  [[gnu::always_inline]] bool take_leaf(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics,
                                        std::uint32_t leaf, std::uint32_t tests, EventClass& stop) {
    ++statistics.steps.leaves;
    statistics.steps.lists += tests != 0 ? 1 : 0;
    cursor.time = sim::add_ticks(cursor.time, ticks_.leaf);
    cursor.list_count = tests;
    cursor.entry = entries_ + topology_[leaf].first;
    cursor.entry_end = cursor.entry + tests;
    return refer_node<RunAhead>(node, cursor, statistics, leaf, stop) &&
           finish_leaf<RunAhead>(node, cursor, statistics, stop);
  }

  // Bytes of the reference at the cursor: a whole line with a cache, else its own part of the unit.
  std::uint32_t reference_bytes(const Cursor& cursor) const {
    if constexpr (Caches::present) {
      return input_.config.cache.cache.line;
    } else {
      const memory::Address next = ((cursor.at >> unit_shift_) + 1) << unit_shift_;
      return static_cast<std::uint32_t>(std::min(cursor.end, next) - cursor.at);
    }
  }
  void pass_unit(Cursor& cursor) const { cursor.at = ((cursor.at >> unit_shift_) + 1) << unit_shift_; }

  void read_local(Cursor& cursor, NodeStatistics& statistics) const {
    const std::int64_t width = input_.config.local.width;
    const sim::Ticks transfer =
        sim::multiply_ticks(local_beat_, (std::int64_t{reference_bytes(cursor)} + width - 1) / width);
    statistics.time[static_cast<std::size_t>(Activity::transfer)] += transfer;
    statistics.time[static_cast<std::size_t>(Activity::bank_access)] += local_access_;
    cursor.time = sim::add_ticks(cursor.time, sim::add_ticks(transfer, local_access_));
    pass_unit(cursor);
  }

  void read(std::uint32_t node) {
    const Cursor& cursor = cursors_[node];
    const std::uint32_t bytes = reference_bytes(cursor);
    const memory::Address address = Caches::present ? (cursor.at >> unit_shift_) << unit_shift_ : cursor.at;
    interconnect_of(node).read({port_of(node), address, bytes});
  }

  void read_done(std::uint32_t node, const memory::Service& service) {
    spend(node, Activity::interconnect_wait, service.wait_interconnect);
    spend(node, Activity::transfer, service.transfer);
    spend(node, Activity::bank_wait, service.wait_bank);
    spend(node, Activity::bank_access, service.bank);
    Cursor& cursor = cursors_[node];
    cursor.time = service.done;
    pass_unit(cursor);
    run(node);
  }

  // The oldest write still in the buffer decides whether there is room; a full buffer stalls the node
  // until that write is done, and the write is tried again then.
  void write(std::uint32_t node) {
    Cursor& cursor = cursors_[node];
    const std::uint32_t depth = input_.config.write_buffer;
    const sim::Ticks room_at = writes_[std::size_t{node} * depth + cursor.writes % depth];
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
    writes_[std::size_t{node} * depth + cursor.writes % depth] = done;
    cursor.writes = (cursor.writes + 1) % depth;
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
  Caches caches_;
  const accel::TopologyNode* topology_;
  const std::uint32_t* entries_;
  const std::uint32_t* rank_;  // null: records lie in the order of node numbers
  std::uint32_t node_bytes_;
  std::uint32_t entry_bytes_;
  std::uint32_t primitive_bytes_;
  StepTicks ticks_;
  sim::Ticks local_access_;
  sim::Ticks local_beat_;
  unsigned unit_shift_ = 0;
  bool run_ahead_;
  bool local_database_;
  std::vector<Cursor> cursors_;
  std::vector<NodeStatistics> statistics_;
  std::vector<sim::Ticks> writes_;  // when each entry of each node's write buffer is free
  std::vector<Client> clients_;
  std::vector<memory::Interconnect*> interconnects_;
  sim::Ticks end_ = 0;
};

}  // namespace marti::processors
