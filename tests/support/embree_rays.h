// What Embree finds for given rays.
#pragma once

#include <vector>

#include "accel/ray.h"
#include "scenes/scene.h"

namespace marti::tests {

/// What each of the scene's given rays hits among its triangles, by Embree's kernels in floats, robust ones.
/// Of a ray that any hit will do for, primitive 0 says that there is one. Throws InternalError when Embree
/// fails.
[[nodiscard]] std::vector<accel::Hit> embree_hits(const scenes::Scene& scene);

}  // namespace marti::tests
