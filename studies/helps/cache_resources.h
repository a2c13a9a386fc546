// The resources of caches: size, ways, line.
#pragma once

#include <cstdint>
#include <vector>

#include "studies/helps/resource.h"

namespace marti::studies::helps {

/// Adds those of the machine's first- and second-level caches. `database_bytes`: of one copy of the database.
/// A size grows by a tenth of the sets (or doubles where that cannot be built); at its best it is the next
/// power of two from the database on, so that each line has a place of its own in a cache for all records.
/// Ways become the next number that divides the lines; at their best all lines are one set.
void add_caches(const Changer& changer, const processors::machine::MachineConfig& machine,
                std::uint64_t database_bytes, std::vector<Resource>& resources);

}  // namespace marti::studies::helps
