// What nodes compute and what caches of several shapes miss, from one pass over their part of the log,
// without a machine around them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "memory/cache_config.h"
#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"

namespace marti::processors {

struct OnePass {
  StepCounts steps;                  ///< all of them, pixels finished included
  std::int64_t references = 0;       ///< lines touched
  std::vector<std::int64_t> misses;  ///< of each shape
  std::uint64_t words = 0;           ///< of the log
};

/// The packets of each of some nodes, whose caches begin empty, through LRU caches of all `shapes` at once
/// (memory/all_ways.h, memory/stack_distance.h). `config` says the line, the layout and the packets; it must
/// have a unified cache and a given tree. Sums over the nodes. Throws InternalError for another machine, or
/// a shape of another line or of 0 sets.
[[nodiscard]] OnePass one_pass(const WorkLog& log, const MachineConfig& config,
                               std::span<const memory::CacheShape> shapes,
                               std::span<const std::vector<std::uint64_t>> packets_of_node);

/// Words of the log of each packet, in the order in which packets are handed out: what is known of a packet
/// before it is replayed.
[[nodiscard]] std::vector<std::uint64_t> words_of_packets(const WorkLog& log, const PacketConfig& config);

}  // namespace marti::processors
