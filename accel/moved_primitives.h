// Which primitives of a scene have moved between two frames.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/triangles.h"

namespace marti::accel {

/// The ids of the primitives that differ in any bit of their coordinates, ascending. Throws UserError when
/// the numbers of triangles or of other primitives differ.
[[nodiscard]] std::vector<std::uint32_t> moved_primitives(const TriangleSet& before,
                                                          const TriangleSet& after);

}  // namespace marti::accel
