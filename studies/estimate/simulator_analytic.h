// Estimates without simulating time: exact compute cycles and cache misses of some nodes from one pass over
// the log, and mean values of a closed network for the contention.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "memory/cache_config.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "studies/estimate/simulator_figures.h"

namespace marti::studies::estimate {

/// Throws UserError with the reason unless the machine is one cluster of the image scheme with a given tree,
/// dynamic assignment, one context without prefetching, unified LRU caches of one level, a shared database,
/// and an ideal interconnect or a bus first come, first served.
void check_analytic(const processors::machine::MachineConfig& machine);

struct AnalyticOptions {
  /// Nodes whose packets are walked; at most all there are.
  std::uint32_t walked_nodes = 1;
};

/// One estimate for each cache shape in `caches` (with the machine's line size) in place of the machine's
/// own, from one pass over the log. Of n consecutive packets each of the n nodes is assumed to have one.
/// Contention: exact mean values (M. Reiser, S. S. Lavenberg, JACM 27(2), 1980) of the nodes as customers,
/// the bus and the banks as queues, for every number of nodes that are busy at the same time; packets take
/// times in proportion to their words in the log. Each estimate's work is that of the whole pass. The
/// estimate for one node with an ideal interconnect is exact unless its write buffer fills.
[[nodiscard]] std::vector<Estimate> estimate_analytically(const processors::program::WorkLog& log,
                                                          const processors::machine::MachineConfig& machine,
                                                          std::span<const memory::CacheShape> caches,
                                                          const AnalyticOptions& options);

}  // namespace marti::studies::estimate
