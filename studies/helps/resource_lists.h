// The resources of those parts of a machine that have files of their own; resources.cpp puts all together.
#pragma once

#include <cstdint>
#include <vector>

#include "studies/helps/resource.h"

namespace marti::studies::helps {

/// Those of the machine's first- and second-level caches. `database_bytes`: of one copy of the database. A
/// size grows by a tenth of the sets (or doubles where that cannot be built); at its best it is the next
/// power of two from the database on, so that each line has a place of its own in a cache for all records.
/// Ways become the next number that divides the lines; at their best all lines are one set.
void add_caches(const Changer& changer, const processors::machine::MachineConfig& machine,
                std::uint64_t database_bytes, std::vector<Resource>& resources);

/// Those of a memory of DRAM.
void add_dram(const Changer& changer, const memory::DramConfig& dram, std::vector<Resource>& resources);

/// The network, for rays that move or a distributed database; messages, queues and the rays in flight; the
/// nodes of each stage of a pipeline, which are added to the machine; the level at which space is cut.
void add_flow(const Changer& changer, const processors::machine::MachineConfig& machine,
              std::vector<Resource>& resources);

}  // namespace marti::studies::helps
