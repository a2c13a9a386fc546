// The space scheme's division of a scene among the nodes of a cluster.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/layout.h"
#include "processors/flow/space/region_map.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "sim/time.h"

namespace marti::processors::flow {

/// Every cluster holds the whole scene, and all are divided in the same way.
struct SpacePlan {
  RegionMap regions;
  std::vector<std::uint32_t> node_of_region;  ///< number of the node in the cluster
  std::vector<std::uint32_t> owner;           ///< for each tree node its node; RegionMap::top: every node
  std::vector<std::uint64_t> memory_bytes;    ///< size of the database part that each node of a cluster holds
  std::uint64_t duplicated_primitives = 0;    ///< primitive records in a cluster beyond one of each
  sim::Ticks sampling_work = 0;               ///< sampled: compute time of the pre-pass, before the frame
};

/// A node's memory holds the top, the records and lists of its regions, one record of each primitive that
/// they list, all materials and all textures. Throws UserError for a level, a sample step or a message buffer
/// of 0.
[[nodiscard]] SpacePlan plan_space(const program::WorkLog& log, const machine::MachineConfig& config,
                                   const memory::Layout& layout);

}  // namespace marti::processors::flow
