// The intersection test of any primitive of a set: the one function by which structures test primitives.
#pragma once

#include <cstdint>

#include "accel/quadric_kernel.h"
#include "accel/triangles.h"
#include "accel/watertight.h"

namespace marti::accel {

/// Tests primitive `id` of the set. True when it became the best hit; `best` then holds it.
template <class Real>
inline bool intersect_primitive(const RaySetup<Real>& ray, const TriangleSet& set, std::uint32_t id,
                                Best<Real>& best) {
  if (id < set.triangles()) [[likely]] {
    return intersect(ray, set[id], id, best);
  }
  return intersect_quadric(ray, set.quadric(id), id, best);
}

}  // namespace marti::accel
