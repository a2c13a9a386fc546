#include "processors/machine/machine_config.h"

#include <bit>
#include <string>

#include "processors/machine/combinations.h"
#include "sim/key_error.h"

namespace marti::processors::machine {

namespace {

// A tree that is built while others read it needs a memory that serves requests in their order.
void check_order(const MachineConfig& config) {
  if (config.build.sharing != Sharing::shared || !writes_done_later(config)) {
    return;
  }
  throw sim::KeyError("build.sharing",
                      "a read may overtake another node's write on a bus that is not granted first come "
                      "first served, and in a "
                      "memory that is not, so nodes cannot share a tree that is built; use "
                      "interconnect.arbitration = \"fifo\" "
                      "and dram.policy = \"fcfs\", or \"private\" or \"none\"");
}

void check_dram(const MachineConfig& config) {
  if (!config.banks.dram) {
    return;
  }
  memory::check(*config.banks.dram, config.reference_bytes());
  if (config.banks.dram->policy != memory::DramPolicy::frfcfs) {
    return;
  }
  if (config.interconnect.kind == memory::InterconnectKind::bus &&
      config.interconnect.mode == memory::BusMode::held) {
    throw sim::KeyError("dram.policy",
                        "\"frfcfs\" has nothing to choose from on a bus that each read keeps until its data "
                        "have come; use interconnect.mode = \"split\", or \"fcfs\"");
  }
}

void check_distribution(const MachineConfig& config) {
  const DistributionConfig& distribution = config.distribution;
  if (!std::has_single_bit(distribution.interleave)) {
    throw sim::KeyError("database.interleave", "must be a power of two");
  }
  const bool cached = config.cache.organisation != CacheOrganisation::none;
  const std::uint32_t unit = config.reference_bytes();
  if (distribution.interleave < unit) {
    throw sim::KeyError(
        "database.interleave",
        "must be at least " +
            (cached ? "a cache line" : std::string("what one reference reads without a cache")) + ", " +
            std::to_string(unit) + " bytes");
  }
  if (distribution.header_bytes == 0 || config.network.width == 0) {
    throw sim::KeyError(distribution.header_bytes == 0 ? "database.header" : "network.width",
                        "must be at least one byte");
  }
}

}  // namespace

std::vector<FirstLevelCache> first_level_caches(const NodeCacheConfig& config) {
  if (config.organisation == CacheOrganisation::none) {
    return {};
  }
  if (config.organisation == CacheOrganisation::unified) {
    return {{config.cache, "cache.size"}};
  }
  std::vector<FirstLevelCache> caches;
  for (std::size_t i = 0; i < split_caches; ++i) {
    caches.push_back({config.cache, split_size_keys[i]});
    caches.back().cache.size = config.split_sizes[i];
  }
  return caches;
}

bool writes_done_later(const MachineConfig& config) {
  return config.placement == Placement::distributed ||
         (config.interconnect.kind == memory::InterconnectKind::bus &&
          config.interconnect.arbitration != memory::Arbitration::fifo) ||
         (config.banks.dram && config.banks.dram->policy == memory::DramPolicy::frfcfs);
}

MachineConfig one_node_of(const MachineConfig& config) {
  MachineConfig one = config;
  one.clusters = 1;
  one.nodes = 1;
  one.count = {};
  if (config.scheme == Scheme::pipeline) {
    one.scheme = Scheme::image;
    one.pixels = Pixels::collected;
    one.host.assignment = Assignment::blocks;
  }
  return one;
}

void check(const MachineConfig& config) {
  if (config.clusters == 0 || config.nodes == 0) {
    throw sim::KeyError("machine.nodes", "a machine needs at least one cluster of one node");
  }
  if (std::uint64_t{config.clusters} * config.nodes > most_nodes) {
    throw sim::KeyError("machine.nodes", "a machine of more than 2^24 nodes");
  }
  check_combinations(config);
  check_contexts(config);
  check_simt(config);
  check_flow(config);
  if (config.write_buffer == 0 || config.word_bytes == 0) {
    throw sim::KeyError(config.write_buffer == 0 ? "node.write_buffer" : "node.word", "must not be 0");
  }
  if (config.placement == Placement::replicated && config.build.sharing == Sharing::shared) {
    throw sim::KeyError("build.sharing",
                        "nodes with a database each (database.placement = \"replicated\") have no tree to "
                        "share; use \"private\" or \"none\"");
  }
  check_order(config);
  if (config.placement == Placement::distributed) {
    check_distribution(config);
  }
  if ((config.placement != Placement::shared || config.build.sharing == Sharing::private_trees ||
       config.scheme == Scheme::space) &&
      config.local.width == 0) {
    throw sim::KeyError("local.width", "local memory must be at least one byte wide");
  }
  check_dram(config);
  for (const FirstLevelCache& first : first_level_caches(config.cache)) {
    (void)sim::KeyError::reported_under(first.size_key, [&] { return memory::shape_of(first.cache); });
  }
  check_second_level(config);
  check_counting(config);
}

}  // namespace marti::processors::machine
