#include "processors/replay/energy_counts.h"

#include "processors/replay/cache_laws.h"
#include "processors/walk/node_caches.h"

namespace marti::processors::replay {

namespace {

// Adds the nodes' look-ups: without a cache there are none.
void add_first_level(const machine::MachineConfig& config, const cost::ReferenceCounts& references,
                     energy::EnergyCounts& counts) {
  if (config.cache.organisation == machine::CacheOrganisation::none) {
    return;
  }
  const bool split = config.cache.organisation == machine::CacheOrganisation::split;
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    const std::size_t cache = split ? walk::split_cache_of.at(kind) : 0;
    sim::merge(counts.l1.at(cache), {references.hits.at(kind), references.misses.at(kind)});
  }
}

// Of what is behind the first level. `reads`: of banks and of nodes' own memories; those of DRAM are known.
energy::EnergyCounts counts_of_memory(const machine::MachineConfig& config, const MachineResult& result,
                                      std::int64_t reads) {
  energy::EnergyCounts counts;
  counts.l2 = result.l2.counters();
  memory::NetworkStatistics network;
  for (const ClusterResult& cluster : result.clusters) {
    counts.memory_writes += cluster.interconnect.writes;
    if (cluster.distributed) {
      sim::merge(network, cluster.distributed->network);  // its messages carry what the nodes read and write
    } else {
      counts.interconnect_bytes += cluster.interconnect.bytes;
    }
  }
  for (const memory::NetworkStatistics& part : result.flow.networks) {
    sim::merge(network, part);
  }
  // An ideal network has no links: its messages cross one.
  counts.hop_bytes = config.network.kind == memory::NetworkKind::ideal ? network.bytes : network.link_bytes;
  counts.memory_reads = reads;
  for (const ClusterResult& cluster : result.clusters) {
    for (const memory::DramStatistics& channel : cluster.dram) {
      sim::merge(counts.dram, channel);
    }
    if (!cluster.dram.empty()) {
      // All others are accesses of DRAM.
      counts.memory_reads = result.build.counts().local_misses;
      counts.memory_writes = 0;
    }
  }
  counts.end = result.end;
  return counts;
}

}  // namespace

energy::EnergyCounts energy_counts(const program::WorkLog& log, const machine::MachineConfig& config,
                                   const MachineResult& result) {
  energy::EnergyCounts counts = counts_of_memory(config, result, reads_of_memory(config, result));
  counts.traversal = log.traversal;
  counts.mailboxes = log.mailboxes;
  counts.integrator = log.integrator;
  counts.steps = result.steps();
  counts.build = result.build.counts();
  add_first_level(config, result.references(), counts);
  if (config.cache.organisation != machine::CacheOrganisation::none) {
    counts.l1_prefetches = result.contexts.counts().issued;
  }
  return counts;
}

energy::EnergyCounts energy_counts(const machine::MachineConfig& config, const DrivenResult& driven) {
  const bool shared = config.l2.sharing == machine::SecondLevel::shared;
  energy::EnergyCounts counts = counts_of_memory(
      config, driven.machine,
      shared ? driven.machine.l2.counters().misses : driven.machine.clusters[0].interconnect.reads);
  add_first_level(config, driven.references, counts);
  return counts;
}

}  // namespace marti::processors::replay
