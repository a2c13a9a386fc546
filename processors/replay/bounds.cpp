#include "processors/replay/bounds.h"

#include <algorithm>
#include <initializer_list>
#include <string>

#include "processors/node/memory_system.h"
#include "processors/walk/law.h"

namespace marti::processors::replay {

namespace {

sim::Ticks part(const cost::NodeStatistics& node, std::initializer_list<cost::ActivityKind> kinds) {
  return cost::sum_of_kinds(kinds, [&](std::size_t i) { return node.time[i]; });
}

// Without waits and idling.
sim::Ticks own_work(const cost::NodeStatistics& node) {
  return part(node, {cost::ActivityKind::computing, cost::ActivityKind::memory});
}

// The bus is held by a read while the bank works, so banks are not queues of their own.
bool bus_holds_banks(const machine::MachineConfig& config) {
  return config.interconnect.kind == memory::InterconnectKind::bus &&
         config.interconnect.mode == memory::BusMode::held;
}

std::vector<double> demands_of(const machine::MachineConfig& config, const ClusterResult& cluster,
                               double reads) {
  std::vector<double> demands;
  const auto busy = static_cast<double>(cluster.interconnect.busy);
  if (config.interconnect.kind == memory::InterconnectKind::bus) {
    demands.push_back(busy / reads);
  }
  if (bus_holds_banks(config)) {
    return demands;
  }
  double accesses = 0.0;
  for (const memory::BankStatistics& bank : cluster.banks) {
    accesses += static_cast<double>(bank.accesses);
    demands.push_back(static_cast<double>(bank.busy) / reads);
  }
  if (config.interconnect.kind == memory::InterconnectKind::crossbar) {
    // Only the sum over the links is counted; each bank's link gets its share by the bank's accesses.
    for (const memory::BankStatistics& bank : cluster.banks) {
      demands.push_back(busy * static_cast<double>(bank.accesses) / accesses / reads);
    }
  }
  return demands;
}

Prediction predict_cluster(const machine::MachineConfig& config, const MachineResult& result,
                           std::uint32_t cluster) {
  Prediction prediction;
  prediction.cluster = cluster;
  prediction.reads = result.clusters[cluster].interconnect.reads;
  const auto reads = static_cast<double>(prediction.reads);
  theory::ClosedNetwork& network = prediction.network;
  network.customers = 0;
  double work = 0.0;
  double delays = 0.0;
  for (std::uint32_t i = 0; i < config.nodes; ++i) {
    const cost::NodeStatistics& node = result.nodes[cluster * config.nodes + i];
    network.customers += had_work(node) ? 1 : 0;
    work += static_cast<double>(own_work(node));
    delays += static_cast<double>(part(node, {cost::ActivityKind::delay}));
  }
  network.customers = std::max<std::uint64_t>(network.customers, 1);
  network.demands = demands_of(config, result.clusters[cluster], reads);
  network.think = std::max(0.0, (work + delays) / reads - network.demand());
  if (network.demand() + network.think <= 0.0) {
    return prediction;
  }
  const auto n = static_cast<double>(network.customers);
  prediction.asymptotic_low = std::max(work / n, network.largest() * reads);
  const theory::ThroughputRange balanced = theory::balanced_job_bounds(network);
  prediction.balanced_low = reads / balanced.high;
  prediction.balanced_high = reads / balanced.low;
  const theory::MeanValues values = theory::mean_values(network);
  prediction.mean_value = reads / values.throughput;
  prediction.exact = values.exact;
  return prediction;
}

}  // namespace

bool had_work(const cost::NodeStatistics& node) {
  if (node.packets > 0 || own_work(node) > 0) {
    return true;
  }
  std::int64_t steps = 0;
  sim::for_each_counter(node.steps, [&](const auto& /*counter*/, std::int64_t value) { steps += value; });
  return steps > 0;
}

sim::Ticks FrameBounds::least() const { return std::max({node_work, interconnect, bank}); }

FrameBounds frame_bounds(const machine::MachineConfig& config, const MachineResult& result) {
  FrameBounds bounds;
  sim::Sum all = 0;
  sim::Ticks workers = 0;
  for (std::uint32_t node = 0; node < result.nodes.size(); ++node) {
    const sim::Ticks work = own_work(result.nodes[node]);
    if (work > bounds.node_work) {
      bounds.node_work = work;
      bounds.busiest_node = node;
    }
    all += work;
    workers += had_work(result.nodes[node]) ? 1 : 0;
  }
  bounds.mean_work = workers > 0 ? static_cast<sim::Ticks>(all / workers) : 0;
  // Between two accesses a bank is busy for its busy time; the last access ends with its data instead. A
  // distributed memory is busy for exactly as long as its accesses take, and DRAM for as long as it moves
  // data.
  const sim::Ticks last = config.placement == machine::Placement::distributed || config.banks.dram
                              ? 0
                              : config.banks.clock.cycles(config.banks.access_cycles) -
                                    config.banks.clock.cycles(config.banks.busy_cycles);
  for (const ClusterResult& cluster : result.clusters) {
    if (node::has_links(config) && cluster.interconnect.links > 0) {
      const std::int64_t links = cluster.interconnect.links;
      const auto each = static_cast<sim::Ticks>((cluster.interconnect.busy + links - 1) / links);
      bounds.interconnect = std::max(bounds.interconnect, each);
    }
    for (const memory::BankStatistics& bank : cluster.banks) {
      if (bank.accesses > 0) {
        bounds.bank = std::max(bounds.bank, bank.busy + last);
      }
    }
  }
  return bounds;
}

void check_bounds(const machine::MachineConfig& config, const MachineResult& result) {
  const FrameBounds bounds = frame_bounds(config, result);
  walk::require(result.end >= bounds.least(), "the frame ends after " + std::to_string(result.end) +
                                                  " ticks, but its busiest resource works for " +
                                                  std::to_string(bounds.least()));
}

std::optional<Prediction> predict(const machine::MachineConfig& config, const MachineResult& result) {
  // How long a DRAM bank takes depends on the accesses before, so it is no station with a demand of its own.
  if (config.ports_of_node() > 1 || config.kind == machine::NodeKind::simt ||
      config.placement == machine::Placement::distributed || config.banks.dram) {
    return std::nullopt;
  }
  std::optional<Prediction> longest;
  for (std::uint32_t cluster = 0; cluster < result.clusters.size(); ++cluster) {
    if (result.clusters[cluster].interconnect.reads == 0) {
      continue;
    }
    Prediction prediction = predict_cluster(config, result, cluster);
    if (prediction.mean_value > 0.0 && (!longest || prediction.mean_value > longest->mean_value)) {
      longest = std::move(prediction);
    }
  }
  return longest;
}

}  // namespace marti::processors::replay
