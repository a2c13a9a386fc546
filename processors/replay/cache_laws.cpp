#include "processors/replay/cache_laws.h"
#include "processors/walk/law.h"

#include "sim/error.h"

namespace marti::processors::replay {

namespace {

void check_private(const MachineResult& result) {
  walk::require(result.l2.caches.size() == result.nodes.size(), "every node has a second level");
  for (std::size_t node = 0; node < result.nodes.size(); ++node) {
    const std::int64_t prefetches = result.contexts.nodes.empty() ? 0 : result.contexts.nodes[node].issued;
    walk::require(
        result.l2.caches[node].references() == result.nodes[node].references.all_misses() + prefetches,
        "what misses in a node's first level, and what it prefetches, is what its second level is asked "
        "for");
  }
}

void check_cluster(const ClusterResult& cluster, const memory::CacheCounters* cache) {
  const memory::InterconnectStatistics& traffic = cluster.interconnect;
  std::int64_t accesses = 0;
  for (const memory::BankStatistics& bank : cluster.banks) {
    accesses += bank.accesses;
  }
  if (cache != nullptr) {
    walk::require(cache->references() == traffic.reads,
                  "every read of the interconnect asks the shared cache");
  }
  walk::require(accesses == (cache != nullptr ? cache->misses : traffic.reads) + traffic.writes,
                "every write, and every read that no cache serves, is an access of a bank");
}

}  // namespace

std::int64_t reads_beyond_caches(const machine::MachineConfig& config, const MachineResult& result) {
  return config.l2.sharing == machine::SecondLevel::private_caches
             ? result.l2.counters().misses
             : result.references().all_misses() + result.contexts.counts().issued;
}

std::int64_t reads_of_memory(const machine::MachineConfig& config, const MachineResult& result) {
  // Every read of a cluster asks a shared second level, but what a node reads in its own memory.
  if (!result.l2.caches.empty() && config.l2.sharing == machine::SecondLevel::shared) {
    return result.l2.counters().misses + result.build.counts().local_misses;
  }
  return reads_beyond_caches(config, result) + result.build.counts().locks;
}

void check_second_level_laws(const machine::MachineConfig& config, const MachineResult& result) {
  if (config.l2.sharing == machine::SecondLevel::private_caches) {
    check_private(result);
  }
  const bool shared = config.l2.sharing == machine::SecondLevel::shared;
  walk::require(!shared || result.l2.caches.size() == result.clusters.size(),
                "every cluster has a shared second level");
  for (std::size_t cluster = 0; cluster < result.clusters.size(); ++cluster) {
    // A distributed memory's banks also serve their own nodes, without the network: it has laws of its own.
    if (!result.clusters[cluster].banks.empty() && !result.clusters[cluster].distributed) {
      check_cluster(result.clusters[cluster], shared ? &result.l2.caches[cluster] : nullptr);
    }
  }
}

}  // namespace marti::processors::replay
