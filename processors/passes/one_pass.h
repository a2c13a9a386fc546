// The steps of nodes and the misses of caches of several shapes, from one pass over the nodes' parts of the
// log, without a machine around them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "memory/cache_config.h"
#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"

namespace marti::processors::passes {

struct OnePass {
  cost::StepCounts steps;            ///< all steps, pixels finished included
  std::int64_t references = 0;       ///< lines touched
  std::vector<std::int64_t> misses;  ///< of each shape
  std::uint64_t words = 0;           ///< words of the log
};

/// Takes the packets of each of some nodes, whose caches begin empty, through LRU caches of all `shapes` at
/// once (memory/all_ways.h, memory/stack_distance.h). `config` gives the line, the layout and the packets; it
/// must have a unified cache and a given tree. Returns sums over the nodes. Throws InternalError for another
/// machine, or a shape of another line or of 0 sets.
[[nodiscard]] OnePass one_pass(const program::WorkLog& log, const machine::MachineConfig& config,
                               std::span<const memory::CacheShape> shapes,
                               std::span<const std::vector<std::uint64_t>> packets_of_node);

/// The number of words of the log of each packet, in the order in which packets are handed out. It is known
/// before a packet is replayed.
[[nodiscard]] std::vector<std::uint64_t> words_of_packets(const program::WorkLog& log,
                                                          const machine::PacketConfig& config);

}  // namespace marti::processors::passes
