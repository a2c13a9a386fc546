#include "memory/network.h"

#include <algorithm>
#include <vector>

#include "memory/routes.h"
#include "sim/error.h"

namespace marti::memory {

using sim::add_ticks;
using sim::Ticks;

namespace {

// What all kinds have in common: ports, the time of beats, counting.
class CountedNetwork : public Network {
 public:
  Delivery send(Ticks now, std::uint32_t from, std::uint32_t to, std::uint32_t bytes) override {
    sim::ensure(from <= nodes_ && to <= nodes_ && bytes > 0, "a message between ports that are not there");
    if (from == to) {
      return {now, 0, 0};
    }
    const std::int64_t hops_before = statistics_.hops;
    const Delivery delivery = carry(now, from, to, beats(bytes));
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
        nodes_(nodes),
        width_(config.width),
        beat_(config.clock.cycles(config.cycles_per_beat)) {}

  virtual Delivery carry(Ticks now, std::uint32_t from, std::uint32_t to, Ticks data) = 0;

  Ticks beats(std::uint32_t bytes) const {
    return sim::multiply_ticks(beat_, (std::int64_t{bytes} + width_ - 1) / width_);
  }

  Ticks hop_;
  NetworkStatistics statistics_;

 private:
  std::uint32_t nodes_;
  std::int64_t width_;
  Ticks beat_;
};

class IdealNetwork final : public CountedNetwork {
 public:
  IdealNetwork(const NetworkConfig& config, std::uint32_t nodes) : CountedNetwork(config, nodes) {}
  std::uint32_t hops(std::uint32_t /*from*/, std::uint32_t /*to*/) const override { return 0; }
  Ticks unloaded(std::uint32_t from, std::uint32_t to, std::uint32_t /*bytes*/) const override {
    return from == to ? 0 : hop_;
  }

 private:
  Delivery carry(Ticks now, std::uint32_t /*from*/, std::uint32_t /*to*/, Ticks /*data*/) override {
    return {add_ticks(now, hop_), 0, hop_};
  }
};

// With `holds_hop` a link is also held for the latency, so that only one message is on its way at a time.
template <class Routes, bool holds_hop>
class RoutedNetwork final : public CountedNetwork {
 public:
  RoutedNetwork(const NetworkConfig& config, std::uint32_t nodes)
      : CountedNetwork(config, nodes), routes_(nodes), free_at_(routes_.table_size()) {
    statistics_.links = routes_.links();
  }
  std::uint32_t hops(std::uint32_t from, std::uint32_t to) const override {
    return from == to ? 0 : routes_.hops(from, to);
  }
  Ticks unloaded(std::uint32_t from, std::uint32_t to, std::uint32_t bytes) const override {
    return from == to ? 0 : add_ticks(sim::multiply_ticks(hop_, hops(from, to)), beats(bytes));
  }

 private:
  Delivery carry(Ticks now, std::uint32_t from, std::uint32_t to, Ticks data) override {
    const Ticks held = holds_hop ? add_ticks(hop_, data) : data;
    Ticks head = now;
    Delivery delivery;
    std::int64_t links = 0;
    routes_.route(from, to, [&](std::size_t link) {
      const Ticks start = std::max(head, free_at_[link]);
      free_at_[link] = add_ticks(start, held);
      delivery.wait += start - head;
      head = add_ticks(start, hop_);
      ++links;
    });
    statistics_.hops += links;
    statistics_.busy = add_ticks(statistics_.busy, sim::multiply_ticks(held, links));
    delivery.arrival = add_ticks(head, data);
    delivery.transfer = delivery.arrival - now - delivery.wait;
    return delivery;
  }

  Routes routes_;
  std::vector<Ticks> free_at_;  // when each link is free
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
      return std::make_unique<RoutedNetwork<BusRoutes, true>>(config, nodes);
    case NetworkKind::crossbar:
      return std::make_unique<RoutedNetwork<CrossbarRoutes, false>>(config, nodes);
    case NetworkKind::hypercube:
      return std::make_unique<RoutedNetwork<WithHost<HypercubeRoutes>, false>>(config, nodes);
    case NetworkKind::mesh:
      break;
  }
  return std::make_unique<RoutedNetwork<WithHost<MeshRoutes>, false>>(config, nodes);
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
  return links * sizeof(Ticks);
}

}  // namespace marti::memory
