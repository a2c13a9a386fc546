// A hierarchy built by Embree's rtcBuildBVH, for its cost.
#pragma once

#include <cstddef>
#include <cstdint>

#include "accel/triangles.h"

namespace marti::tests {

/// The cost of Embree's hierarchy over the triangles, as Bvh::sah_cost() counts it: built in its medium
/// quality with up to `width` children and `largest_leaf` primitives of a leaf, a visit costing as much as a
/// test. Throws InternalError when Embree fails.
[[nodiscard]] double embree_sah_cost(const accel::TriangleSet& triangles, unsigned width,
                                     unsigned largest_leaf);

}  // namespace marti::tests
