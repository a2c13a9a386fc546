#include "studies/figures/machine_totals.h"

#include <algorithm>

#include "sim/statistics.h"

namespace marti::studies::figures {

namespace {

// Adds a part's statistics to those of all parts of its kind, which have no value if there is no part.
template <class S>
void merge_into(std::optional<sim::Sums<S>>& sums, const S& part) {
  if (!sums) {
    sums.emplace();
  }
  sums->merge(part);
}

void merge_waits(std::optional<memory::WaitStatistics>& sum, const memory::WaitStatistics& part) {
  if (!sum) {
    sum.emplace();
  }
  sim::merge(*sum, part);
  sum->histogram.merge(part.histogram);
}

void add_network(MachineTotals& totals, const memory::NetworkStatistics& part) {
  merge_into(totals.network, part);
  merge_waits(totals.network_waits, part.waits);
  totals.most_network_busy = std::max(totals.most_network_busy, part.busy);
}

void add_cluster(MachineTotals& totals, const processors::replay::ClusterResult& cluster) {
  merge_into(totals.interconnect, cluster.interconnect);
  merge_waits(totals.interconnect_waits, cluster.interconnect.waits);
  totals.most_interconnect_busy = std::max(totals.most_interconnect_busy, cluster.interconnect.busy);
  for (const memory::BankStatistics& part : cluster.banks) {
    merge_into(totals.bank, part);
    merge_waits(totals.bank_waits, part.waits);
    totals.most_bank_busy = std::max(totals.most_bank_busy, part.busy);
    ++totals.banks;
  }
  for (const memory::DramStatistics& channel : cluster.dram) {
    merge_into(totals.dram, channel);
  }
  if (cluster.distributed) {
    merge_into(totals.distributed, cluster.distributed->accesses);
    add_network(totals, cluster.distributed->network);
  }
}

}  // namespace

MachineTotals totals_of(const processors::replay::MachineResult& result) {
  MachineTotals totals;
  for (const processors::replay::ClusterResult& cluster : result.clusters) {
    add_cluster(totals, cluster);
  }
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    add_network(totals, network);
  }
  for (const processors::cost::NodeStatistics& node : result.nodes) {
    merge_into(totals.node, node);
  }
  for (const processors::flow::FlowCounts& node : result.flow.nodes) {
    merge_into(totals.flow, node);
  }
  for (const memory::WaitStatistics& waits : result.l2.waits) {
    merge_waits(totals.l2_waits, waits);
  }
  return totals;
}

}  // namespace marti::studies::figures
