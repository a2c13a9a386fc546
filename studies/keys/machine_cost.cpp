#include "studies/keys/machine_cost.h"

#include <cstdint>

#include "sim/rounded.h"

namespace marti::studies::keys {

namespace {

using processors::machine::MachineConfig;
using processors::machine::SecondLevel;

double kib(std::uint64_t bytes) { return static_cast<double>(bytes) / 1024.0; }

// Bytes of a node's first level.
std::uint64_t first_level(const MachineConfig& machine) {
  std::uint64_t bytes = 0;
  for (const auto& first : processors::machine::first_level_caches(machine.cache)) {
    bytes += first.cache.size;
  }
  return bytes;
}

double node_cost(const Prices& prices, const MachineConfig& machine) {
  double cost = prices.node + prices.context * static_cast<double>(machine.contexts - 1) +
                prices.cache_kib * kib(first_level(machine));
  if (machine.l2.sharing == SecondLevel::private_caches) {
    cost += prices.l2_kib * kib(machine.l2.cache.size);
  }
  const bool network = machine.scheme != processors::machine::Scheme::image ||
                       machine.placement == processors::machine::Placement::distributed;
  if (network && machine.network.kind != memory::NetworkKind::ideal) {
    cost += prices.network_byte * static_cast<double>(machine.network.width);
  }
  return cost;
}

// The cost of a cluster's interconnect to shared memory, and of that memory.
double memory_cost(const Prices& prices, const MachineConfig& machine) {
  const bool shared = machine.scheme != processors::machine::Scheme::space &&
                      machine.placement != processors::machine::Placement::distributed &&
                      machine.interconnect.kind != memory::InterconnectKind::ideal;
  if (!shared) {
    return 0.0;
  }
  const bool crossbar = machine.interconnect.kind == memory::InterconnectKind::crossbar;
  const double banks = static_cast<double>(machine.banks.banks());
  return prices.interconnect_byte * static_cast<double>(machine.interconnect.width) *
             (crossbar ? banks : 1.0) +
         prices.bank * banks;
}

}  // namespace

double cost_of(const Prices& prices, const MachineConfig& machine) {
  double cluster = prices.cluster + node_cost(prices, machine) * static_cast<double>(machine.nodes) +
                   memory_cost(prices, machine);
  if (machine.l2.sharing == SecondLevel::shared) {
    cluster += prices.l2_kib * kib(machine.l2.cache.size);
  }
  // A machine whose decimal prices add up to a budget must not cost more than it for the rounding of sums.
  constexpr int digits = 14;
  return sim::rounded(cluster * static_cast<double>(machine.clusters), digits);
}

}  // namespace marti::studies::keys
