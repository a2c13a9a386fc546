// How many arithmetic operations it takes to split a node of the tree, and what they cost. As with the steps
// of the log (operation_mix.h) the table is measured: it holds what the octree's sorting of triangles into
// children (accel/octree_sort.h) executes when run with a counting scalar. A test measures it again.
#pragma once

#include <cstdint>

#include "processors/cost/cost_model.h"
#include "processors/cost/operation_mix.h"
#include "processors/machine/machine_config.h"
#include "sim/time.h"

namespace marti::processors::cost {

/// Means in thousandths of an operation. listed: one listed primitive against the middle planes (its
/// bounding box, and which children it can meet). overlap: one triangle against one box. child: the planes
/// and boxes of one child.
struct BuildMixes {
  OperationMix listed;
  OperationMix overlap;
  OperationMix child;
};

/// The table that build_cycles prices. Measured on teapot:12 in an octree (max_objects 9, max_level 12). A
/// bsp tree's node is priced by it too: it tests the same triangles against boxes made in the same way.
[[nodiscard]] const BuildMixes& build_mixes();

/// Compute cycles of the parts of a split. They include the fetching and storing of a record's words, but not
/// waiting for memory.
struct BuildCycles {
  std::int64_t lock = 0;     ///< an integer operation, a load and a store
  std::int64_t listed = 0;   ///< one entry of the node's list: fetch its id and primitive, classify it
  std::int64_t overlap = 0;  ///< one overlap test
  std::int64_t child = 0;    ///< make a child and store its record
  std::int64_t entry = 0;    ///< store one entry of a child's list
  std::int64_t publish = 0;  ///< store the node's own record
};
[[nodiscard]] BuildCycles build_cycles(const machine::OperationCycles& cycles, const RecordWords& words);

/// The times of BuildCycles in ticks of one machine.
struct BuildTicks {
  sim::Ticks lock = 0;
  sim::Ticks listed = 0;
  sim::Ticks overlap = 0;
  sim::Ticks child = 0;
  sim::Ticks entry = 0;
  sim::Ticks publish = 0;
};
[[nodiscard]] BuildTicks build_ticks(const machine::MachineConfig& config);

}  // namespace marti::processors::cost
