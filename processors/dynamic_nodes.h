// Nodes of the image scheme on a machine whose tree is built while it is used: packets, misses and pixel
// writes as in ImageNodes, and beside them the building before the frame, locks, waiting, and writes of the
// tree.
#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <utility>

#include "processors/build_report.h"
#include "processors/dynamic_walker.h"
#include "processors/node_array.h"
#include "sim/large_pages.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h. See node_array.h for what the members do.
template <class Caches>
class DynamicNodes final : public NodeArray {
 public:
  DynamicNodes(const ReplayInput& input, sim::Engine& engine, Host& host, Caches caches)
      : input_(input),
        engine_(engine),
        host_(host),
        walker_(input, std::move(caches)),
        cursors_(input.config.all_nodes()),
        statistics_(input.config.all_nodes()),
        built_(input.config.all_nodes()),
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
    order_.resize(cursors_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    if (seed != 0) {
      std::shuffle(order_.begin(), order_.end(), std::mt19937_64(seed));
    }
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

  sim::Ticks end() const override { return end_; }

  void finish() override {
    for (std::size_t node = 0; node < statistics_.size(); ++node) {
      NodeStatistics& statistics = statistics_[node];
      add_counted_time(walker_.ticks(), statistics.steps, statistics.references.all_hits(), statistics.time);
      add_building_time(walker_.times(), built_[node], statistics.time);
      statistics.time[static_cast<std::size_t>(Activity::idle)] = end_ - statistics.finish;
    }
  }

  std::vector<NodeStatistics> statistics() const override { return {statistics_.begin(), statistics_.end()}; }

  BuildResult build_result() const override {
    BuildResult result = report_build(input_, walker_.copies());
    result.start_up = start_up_;
    result.start_up_wait = start_up_wait_;
    result.nodes.assign(built_.begin(), built_.end());
    return result;
  }

  std::size_t bytes_per_node() const override {
    return sizeof(DynamicCursor) + sizeof(NodeStatistics) + sizeof(BuildCounts) + sizeof(sim::Event) +
           input_.config.write_buffer * sizeof(sim::Ticks);
  }

 private:
  // One cluster's ports, with port numbers turned into node numbers.
  class Client final : public memory::InterconnectClient {
   public:
    Client(DynamicNodes& nodes, std::uint32_t first) : nodes_(nodes), first_(first) {}
    void read_done(std::uint32_t port, const memory::Service& service) override {
      nodes_.read_done(first_ + port, service);
    }
    void write_done(std::uint32_t port, sim::Ticks done) override { nodes_.write_done(first_ + port, done); }

   private:
    DynamicNodes& nodes_;
    std::uint32_t first_;
  };

  static constexpr std::uint32_t none = DynamicCursor::none;

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

  // The first node of each cluster builds its database's tree; with a database in every node, each does.
  bool builds_before(std::uint32_t node) const {
    return input_.config.placement == Placement::replicated || port_of(node) == 0;
  }

  // One builder has nothing left to split. The frame begins when all have, and their writes are done.
  void ready(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    cursor.before = false;
    start_up_ = std::max(start_up_, cursor.time);
    if (--builders_left_ == 0) {
      start_up_ = std::max(start_up_, end_);
      begin_frame();
    }
  }

  void begin_frame() {
    for (const std::uint32_t node : order_) {
      const sim::Ticks wait = start_up_ - cursors_[node].time;
      spend(node, Activity::dispatch_wait, wait);
      start_up_wait_ = sim::add_ticks(start_up_wait_, wait);
      cursors_[node].time = start_up_;
      post(EventClass::dispatch, start_up_, node);
    }
  }

  // Gives the node its next packet, or ends it.
  void dispatch(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
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

  void begin_pixel(DynamicCursor& cursor) {
    const std::span<const std::uint32_t> words = input_.log.pixel(cursor.x, cursor.y);
    cursor.word = words.data();
    cursor.word_end = words.data() + words.size();
  }

  // Lets a node work until it needs something shared.
  void run(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    const DynamicStop stop =
        input_.step_by_step ? walker_.template advance<false>(node, cursor, statistics_[node], built_[node])
                            : walker_.template advance<true>(node, cursor, statistics_[node], built_[node]);
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
    walker_.miss(node, cursor, statistics_[node]);
    interconnect_of(node).read({port_of(node), walker_.address(cursor), walker_.bytes(cursor)});
  }

  // The order in which lock transactions are made decides who wins.
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
    spend(node, Activity::interconnect_wait, service.wait_interconnect);
    spend(node, Activity::transfer, service.transfer);
    spend(node, Activity::bank_wait, service.wait_bank);
    spend(node, Activity::bank_access, service.bank);
    DynamicCursor& cursor = cursors_[node];
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

  // A waiting node goes on when it knows that the branch is taken and when it can be seen.
  void go_on_waiting(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    if (cursor.arrived < 0 || cursor.published < 0) {
      return;
    }
    cursor.time = std::max(cursor.arrived, cursor.published);
    spend(node, Activity::lock_wait, cursor.time - cursor.arrived);
    post(EventClass::step, cursor.time, node);
  }

  // The oldest write still in the buffer decides whether there is room; a full buffer stalls the node
  // until that write is done, and the write is tried again then.
  void write(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    const sim::Ticks room_at = writes_[std::size_t{node} * input_.config.write_buffer + cursor.writes];
    if (room_at > cursor.time) {
      spend(node, Activity::queue_full_wait, room_at - cursor.time);
      cursor.time = room_at;
      post(EventClass::write, room_at, node);
      return;
    }
    if (cursor.todo != Todo::step) {
      write_tree(node);
      return;
    }
    ++statistics_[node].writes;
    const std::uint64_t pixel = std::uint64_t{cursor.y} * input_.log.width + cursor.x;
    interconnect_of(node).write({port_of(node), input_.layout.address(memory::RecordKind::pixel, pixel),
                                 input_.layout.record_bytes(memory::RecordKind::pixel)});
    next_pixel(node);
  }

  // A part of a record or list of the tree. Copies of its line in other caches of the cluster are stale; the
  // node's own is written too.
  void write_tree(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
    const memory::Address address = walker_.address(cursor);
    const std::uint32_t bytes = walker_.bytes(cursor);
    ++built_[node].writes;
    built_[node].written_bytes += bytes;
    if constexpr (Caches::present) {
      take_out(node, address);
    }
    interconnect_of(node).write({port_of(node), address, bytes});
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
        built_[node].invalidations += walker_.caches().view(other).remove(line);
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

  // Interconnects serve first come, first served, so they say during the write when it will be done.
  void write_done(std::uint32_t node, sim::Ticks done) {
    DynamicCursor& cursor = cursors_[node];
    const std::uint32_t depth = input_.config.write_buffer;
    writes_[std::size_t{node} * depth + cursor.writes] = done;
    cursor.writes = cursor.writes + 1 == depth ? 0 : cursor.writes + 1;
    last_write_done_ = done;
    end_ = std::max(end_, done);
  }

  void next_pixel(std::uint32_t node) {
    DynamicCursor& cursor = cursors_[node];
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
  DynamicWalker<Caches> walker_;
  sim::LargeVector<DynamicCursor> cursors_;
  sim::LargeVector<NodeStatistics> statistics_;
  sim::LargeVector<BuildCounts> built_;
  sim::LargeVector<sim::Ticks> writes_;  // when each entry of each node's write buffer is free
  std::vector<Client> clients_;
  std::vector<memory::Interconnect*> interconnects_;
  std::vector<std::uint32_t> order_;  // in which first events are posted; it changes nothing
  std::uint32_t builders_left_ = 0;
  sim::Ticks start_up_ = 0;
  sim::Ticks start_up_wait_ = 0;
  sim::Ticks last_write_done_ = 0;
  sim::Ticks end_ = 0;
};

}  // namespace marti::processors
