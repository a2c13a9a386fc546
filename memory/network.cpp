#include "memory/network.h"

#include <type_traits>

#include "memory/beats.h"
#include "memory/line_times.h"
#include "memory/link_times.h"
#include "memory/routes.h"
#include "sim/error.h"

namespace marti::memory {

using sim::add_ticks;
using sim::Ticks;

namespace {

// What all kinds have in common: ports, the time of beats, counting. `Kind` has carry(now, from, to, data),
// which sends the data of a message between two ports and returns its delivery; and of its links it counts
// `links`, `busy` and, for each message, `hops`.
template <class Kind>
class CountedNetwork : public Network {
 public:
  Delivery send(Ticks now, std::uint32_t from, std::uint32_t to, std::uint32_t bytes) override {
    sim::ensure(from <= nodes_ && to <= nodes_ && bytes > 0, "a message between ports that are not there");
    if (from == to) {
      return {now, 0, 0};
    }
    const std::int64_t hops_before = statistics_.hops;
    const Delivery delivery = static_cast<Kind&>(*this).carry(now, from, to, beats_(bytes));
    ++statistics_.messages;
    statistics_.bytes += bytes;
    statistics_.link_bytes += bytes * (statistics_.hops - hops_before);
    statistics_.waits.add(delivery.wait);
    return delivery;
  }
  const NetworkStatistics& statistics() const override { return statistics_; }

 protected:
  CountedNetwork(const NetworkConfig& config, std::uint32_t nodes)
      : hop_(config.clock.cycles(config.hop_cycles)),
        beats_(config.clock.cycles(config.cycles_per_beat), config.width),
        nodes_(nodes) {}

  Ticks hop_;
  NetworkStatistics statistics_;
  Beats beats_;

 private:
  std::uint32_t nodes_;
};

class IdealNetwork final : public CountedNetwork<IdealNetwork> {
 public:
  IdealNetwork(const NetworkConfig& config, std::uint32_t nodes) : CountedNetwork(config, nodes) {}
  Delivery carry(Ticks now, std::uint32_t /*from*/, std::uint32_t /*to*/, Ticks /*data*/) const {
    return {add_ticks(now, hop_), 0, hop_};
  }
  Ticks unloaded(std::uint32_t from, std::uint32_t to, std::uint32_t /*bytes*/) const override {
    return from == to ? 0 : hop_;
  }
};

// A message takes many links in a row only where lines are long; from so many nodes on a mesh is kept in
// pieces.
constexpr std::uint32_t nodes_of_long_lines = 1024;

// `Times` is LinkTimes or LineTimes. With `holds_hop` a link is also held for the latency, so that only one
// message is on its way at a time.
template <class Routes, class Times, bool holds_hop>
class RoutedNetwork final : public CountedNetwork<RoutedNetwork<Routes, Times, holds_hop>> {
  using Base = CountedNetwork<RoutedNetwork<Routes, Times, holds_hop>>;
  using Base::hop_;
  using Base::statistics_;

 public:
  RoutedNetwork(const NetworkConfig& config, std::uint32_t nodes)
      : Base(config, nodes), routes_(nodes), links_(make_times(routes_.table_size(), hop_)) {
    statistics_.links = routes_.links();
  }
  Ticks unloaded(std::uint32_t from, std::uint32_t to, std::uint32_t bytes) const override {
    return from == to ? 0 : add_ticks(sim::multiply_ticks(hop_, routes_.hops(from, to)), Base::beats_(bytes));
  }

  Delivery carry(Ticks now, std::uint32_t from, std::uint32_t to, Ticks data) {
    // No time is later than the arrival, for which it is checked that it fits.
    const Ticks held = holds_hop ? add_ticks(hop_, data) : data;
    Crossing crossing = {static_cast<std::uint64_t>(now), static_cast<std::uint64_t>(hop_),
                         static_cast<std::uint64_t>(held)};
    std::int64_t links = 0;
    routes_.runs(from, to, [&](std::size_t first, std::uint32_t count) {
      links_.take(first, count, crossing);
      links += count;
    });
    statistics_.hops += links;
    statistics_.busy += sim::Sum{held} * links;
    statistics_.data += sim::Sum{data} * links;
    const Ticks hops = sim::multiply_ticks(hop_, links);
    const Ticks transfer = add_ticks(hops, data);
    const auto wait = static_cast<Ticks>(crossing.head - static_cast<std::uint64_t>(now) -
                                         static_cast<std::uint64_t>(hops));
    return {add_ticks(add_ticks(now, wait), transfer), wait, transfer};
  }

 private:
  static Times make_times(std::size_t links, Ticks hop) {
    if constexpr (std::is_same_v<Times, LineTimes>) {
      return LineTimes(links, static_cast<std::uint64_t>(hop));
    } else {
      return LinkTimes(links);
    }
  }

  Routes routes_;
  Times links_;
};

}  // namespace

std::unique_ptr<Network> make_network(const NetworkConfig& config, std::uint32_t nodes) {
  if (config.width == 0) {
    throw sim::UserError("a network's links must be at least one byte wide");
  }
  sim::ensure(nodes > 0, "a network without nodes");
  switch (config.kind) {
    case NetworkKind::ideal:
      return std::make_unique<IdealNetwork>(config, nodes);
    case NetworkKind::bus:
      return std::make_unique<RoutedNetwork<BusRoutes, LinkTimes, true>>(config, nodes);
    case NetworkKind::crossbar:
      return std::make_unique<RoutedNetwork<CrossbarRoutes, LinkTimes, false>>(config, nodes);
    case NetworkKind::hypercube:
      return std::make_unique<RoutedNetwork<WithHost<HypercubeRoutes>, LinkTimes, false>>(config, nodes);
    case NetworkKind::mesh:
      break;
  }
  if (nodes < nodes_of_long_lines) {
    return std::make_unique<RoutedNetwork<WithHost<MeshRoutes>, LinkTimes, false>>(config, nodes);
  }
  return std::make_unique<RoutedNetwork<WithHost<MeshRoutes>, LineTimes, false>>(config, nodes);
}

std::uint64_t network_bytes(const NetworkConfig& config, std::uint32_t nodes) {
  std::uint64_t links = 0;
  switch (config.kind) {
    case NetworkKind::ideal:
      break;
    case NetworkKind::bus:
      links = BusRoutes::table_size();
      break;
    case NetworkKind::crossbar:
      links = CrossbarRoutes(nodes).table_size();
      break;
    case NetworkKind::mesh:
      links = WithHost<MeshRoutes>(nodes).table_size();
      break;
    case NetworkKind::hypercube:
      links = WithHost<HypercubeRoutes>(nodes).table_size();
      break;
  }
  return LineTimes::bytes(links);
}

}  // namespace marti::memory
