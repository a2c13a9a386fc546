// The space scheme's division of a scene: what each node of a cluster holds.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/layout.h"
#include "processors/flow/space/region_map.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "sim/time.h"

namespace marti::processors {

/// Every cluster holds the whole scene and is divided in the same way.
struct SpacePlan {
  RegionMap regions;
  std::vector<std::uint32_t> node_of_region;  ///< number in the cluster
  std::vector<std::uint32_t> owner;           ///< of each tree node; RegionMap::top: every node has it
  std::vector<std::uint64_t> memory_bytes;    ///< of the database, for each node of a cluster
  std::uint64_t duplicated_primitives = 0;    ///< of a cluster: records beyond one of each primitive it holds
  sim::Ticks sampling_work = 0;               ///< sampled: computing of the pre-pass, not part of the frame
};

/// A node's memory holds the top, the records and lists of its regions, one record of each primitive that
/// they list, all materials and all textures. Throws UserError for a level, a sample step or a message buffer
/// of 0.
[[nodiscard]] SpacePlan plan_space(const WorkLog& log, const MachineConfig& config,
                                   const memory::Layout& layout);

}  // namespace marti::processors
