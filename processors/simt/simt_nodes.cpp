#include "processors/simt/simt_nodes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "processors/node/packet_nodes.h"
#include "processors/simt/simt_node.h"
#include "processors/walk/observer.h"

namespace marti::processors::simt {

namespace {

using node::EventClass;

// What PacketNodes keeps of a node; the lanes have their own.
struct SimtCursor {
  std::uint32_t writes = 0;  // where the next pixel write goes in the write buffer
};

// Divides `ticks` in the ratio of the parts by largest remainders, the first of equal ones; all goes to the
// second part if there is no ratio.
std::array<sim::Ticks, 4> divided(sim::Ticks ticks, const std::array<sim::Sum, 4>& parts) {
  std::array<sim::Ticks, 4> shares{};
  const sim::Sum all = parts[0] + parts[1] + parts[2] + parts[3];
  if (all == 0) {
    shares[1] = ticks;
    return shares;
  }
  std::array<sim::Sum, 4> remainders{};
  sim::Ticks rest = ticks;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const sim::Sum whole = parts[i] / all * ticks;
    const sim::Sum product = parts[i] % all * ticks;
    shares[i] = static_cast<sim::Ticks>(whole + product / all);
    remainders[i] = product % all;
    rest -= shares[i];
  }
  for (; rest > 0; --rest) {
    const auto largest = std::max_element(remainders.begin(), remainders.end());
    ++shares[static_cast<std::size_t>(largest - remainders.begin())];
    *largest = -1;
  }
  return shares;
}

class SimtNodes final : public node::PacketNodes<SimtNodes, SimtCursor>, private WriteRoom {
  using Base = node::PacketNodes<SimtNodes, SimtCursor>;
  friend Base;

 public:
  SimtNodes(const walk::ReplayInput& input, sim::Engine& engine, node::Host& host)
      : Base(input, engine, host),
        shared_(input_),
        wakes_(input.config.all_nodes(), never_wakes),
        asked_(input.config.all_nodes()) {
    nodes_.reserve(input.config.all_nodes());
    const WriteRoom& room = *this;
    for (std::uint32_t node = 0; node < input.config.all_nodes(); ++node) {
      nodes_.emplace_back(shared_, room, statistics_[node], node);
      if (input.observer != nullptr) {
        nodes_.back().time().observe();
        told_.push_back(0);
      }
    }
  }

  void start(std::uint64_t seed) override {
    for (const std::uint32_t node : Base::first_order(seed)) {
      wake(node, 0);
      for (std::uint32_t warp = 0; warp < input_.config.simt.warps; ++warp) {
        ask(node, warp);
      }
    }
  }

  void handle(const sim::Event& event) override {
    const std::uint32_t component = event.component();
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        step(component);
        break;
      case EventClass::dispatch:
        dispatch(component % input_.config.all_nodes(), component / input_.config.all_nodes());
        break;
      case EventClass::reply:
        Base::reply(component / ports_, port_of(component / ports_) + component % ports_);
        break;
      case EventClass::memory:
        interconnect_of(component / ports_)
            .proceed(port_of(component / ports_) + component % ports_, event.sequence());
        break;
      case EventClass::read:
        read(component);
        break;
      case EventClass::write:
        write(component);
        break;
    }
  }

  void finish() override {
    const sim::Ticks period = input_.config.clock.period();
    for (const SimtNode& node : nodes_) {
      end_ = std::max(end_, node.last_arrival());
    }
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      cost::NodeStatistics& statistics = statistics_[node];
      nodes_[node].settle(statistics.finish / period);
      tell(node);
      if (input_.observer != nullptr && statistics.finish != end_) {
        input_.observer->spent(node, walk::NodeState::idle, statistics.finish, end_, {});
      }
      for (std::size_t i = 0; i < cost::activities; ++i) {
        statistics.time[i] = sim::multiply_ticks(period, nodes_[node].time().cycles()[i]);
      }
      using A = cost::Activity;
      const auto at = [&](A activity) -> sim::Ticks& {
        return statistics.time[static_cast<std::size_t>(activity)];
      };
      const auto shares = divided(at(A::bank_access), nodes_[node].read_parts());
      at(A::interconnect_wait) = shares[0];
      at(A::transfer) = shares[1];
      at(A::bank_wait) = shares[2];
      at(A::bank_access) = shares[3];
      at(A::idle) += end_ - statistics.finish;
    }
  }

  walk::SecondLevelResult second_level() const override { return shared_.behind.second_level().result(); }
  walk::CacheCountResult cache_counts() const override {
    return shared_.counting ? shared_.counting->result() : walk::CacheCountResult{};
  }
  walk::ContextResult context_result() const override {
    walk::ContextResult result;
    if (input_.config.prefetch.into_unit()) {
      for (const SimtNode& node : nodes_) {
        result.nodes.push_back(node.prefetches());
      }
    }
    return result;
  }
  walk::SimtResult simt_result() const override {
    walk::SimtResult result;
    for (const SimtNode& node : nodes_) {
      result.nodes.push_back(node.time().counts());
    }
    return result;
  }
  std::size_t bytes_per_node() const override { return Base::common_bytes() + nodes_.front().bytes(); }

  // Called by the base.
  void read_done(std::uint32_t port, const memory::Service& service) {
    const std::uint32_t node = port / ports_;
    nodes_[node].arrives(port % ports_, service, this_cycle());
    plan(node);
  }
  void room_is_known(std::uint32_t node, sim::Ticks room) {
    nodes_[node].wake(std::max(shared_.cycle_at(room), this_cycle() + 1));
    plan(node);
  }

 private:
  static constexpr sim::Ticks never_wakes = INT64_MAX;

  [[nodiscard]] std::int64_t this_cycle() const { return engine_.now() / input_.config.clock.period(); }

  [[nodiscard]] bool has_room(std::uint32_t node, std::size_t queued) const override {
    return Base::room_at(node, queued) <= engine_.now();
  }

  void wake(std::uint32_t node, std::int64_t cycle) {
    const sim::Ticks time = input_.config.clock.cycles(cycle);
    if (time < wakes_[node]) {
      wakes_[node] = time;
      post(EventClass::step, time, node);
    }
  }
  // Posts an event for the next cycle in which something is due. To a node that is finished only lines come
  // that it has prefetched.
  void plan(std::uint32_t node) {
    if (nodes_[node].finished()) {
      return;
    }
    if (const std::int64_t cycle = nodes_[node].next_cycle(); cycle != no_cycle) {
      wake(node, cycle);
    }
  }
  // Step 8 waits for the host's answers, which come later in this instant: its event is of class read.
  void ask(std::uint32_t node, std::uint32_t warp) {
    post(EventClass::dispatch, engine_.now(), warp * input_.config.all_nodes() + node);
    if (std::exchange(asked_[node], 1) == 0) {
      post(EventClass::read, engine_.now(), node);
    }
  }

  void step(std::uint32_t node) {
    if (engine_.now() != wakes_[node] || nodes_[node].finished()) {
      return;  // an earlier wake took its place, or the node has nothing more to do
    }
    wakes_[node] = never_wakes;
    nodes_[node].step(this_cycle());
    tell(node);
    take_asks(node);
    if (asked_[node] != 0) {
      return;
    }
    look_up(node);
    if (!nodes_[node].reads.empty()) {
      post(EventClass::read, engine_.now(), node);  // after the requests of other nodes to the host
    }
    plan(node);
  }
  void take_asks(std::uint32_t node) {
    for (const std::uint32_t warp : nodes_[node].asks) {
      ask(node, warp);
    }
    nodes_[node].asks.clear();
  }

  // Tells the observer what the node has done since the last call.
  void tell(std::uint32_t node) {
    if (input_.observer == nullptr) {
      return;
    }
    for (const NodeTime::Piece& piece : nodes_[node].time().take_pieces()) {
      const sim::Ticks from = told_[node];
      told_[node] += input_.config.clock.cycles(piece.cycles);
      input_.observer->spent(node, state_of(piece.activity), from, told_[node], {});
    }
  }
  static walk::NodeState state_of(cost::Activity activity) {
    switch (activity) {
      case cost::Activity::bank_access:
        return walk::NodeState::memory;
      case cost::Activity::queue_full_wait:
        return walk::NodeState::queue_full_wait;
      case cost::Activity::dispatch_wait:
        return walk::NodeState::dispatch_wait;
      case cost::Activity::idle:
        return walk::NodeState::idle;
      default:
        return walk::NodeState::working;
    }
  }

  void dispatch(std::uint32_t node, std::uint32_t warp) {
    const sim::Ticks now = engine_.now();
    SimtNode& its = nodes_[node];
    const std::optional<node::Grant> grant = host_.next(node, now);
    if (!grant) {
      if (its.end_warp(warp)) {
        statistics_[node].finish = now;
        end_ = std::max(end_, now);
      }
      return;
    }
    ++statistics_[node].packets;
    if (input_.observer != nullptr) {
      input_.observer->began_packet(node, grant->packet, grant->start);
    }
    const machine::Packet packet = input_.packets[grant->packet];
    if (grant->start > now) {
      its.expect_packet(warp, packet, shared_.cycle_at(grant->start));
      return;
    }
    its.begin_packet(warp, packet);
    take_asks(node);
  }

  void look_up(std::uint32_t node) {
    nodes_[node].look_up(this_cycle());
    if (!nodes_[node].writes.empty() || nodes_[node].waits_for_room()) {
      post(EventClass::write, engine_.now(), node);
    }
  }

  void read(std::uint32_t node) {
    std::vector<memory::Transaction>& reads = nodes_[node].reads;
    if (std::exchange(asked_[node], 0) != 0) {
      look_up(node);
    }
    for (memory::Transaction& transaction : reads) {
      transaction.port += port_of(node);
      Base::read_memory(node, transaction);
    }
    reads.clear();
    plan(node);
  }

  void write(std::uint32_t node) {
    for (const Write& one : nodes_[node].writes) {
      statistics_[node].writes += one.pixels ? 1 : 0;
      Base::make_write(node, one.at, one.bytes);
    }
    nodes_[node].writes.clear();
    if (nodes_[node].waits_for_room()) {
      const sim::Ticks room = Base::room_at(node, 0);
      if (room == Base::not_known) {
        Base::expect_room(node);
      } else {
        nodes_[node].wake(shared_.cycle_at(room));
      }
    }
    plan(node);
  }

  SimtShared shared_;
  std::vector<SimtNode> nodes_;
  std::vector<sim::Ticks> wakes_;  // when each node's next step event is due
  std::vector<sim::Ticks> told_;   // up to when the observer knows what each node has done
  std::vector<char> asked_;        // whether a warp of the node has asked the host at this instant
};

}  // namespace

std::unique_ptr<node::NodeArray> make_simt_nodes(const walk::ReplayInput& input, sim::Engine& engine,
                                                 node::Host& host) {
  return std::make_unique<SimtNodes>(input, engine, host);
}

}  // namespace marti::processors::simt
