// Whether a primitive of a set, of any kind, meets a box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "accel/box_overlap.h"
#include "accel/quadric_overlap.h"
#include "accel/triangles.h"

namespace marti::accel {

/// As box_overlap.h for triangles and quadric_overlap.h for the others: never false when they meet.
template <class Real>
[[nodiscard]] inline bool overlaps(const TriangleSet& set, std::uint32_t id,
                                   const std::array<Real, 3>& center, const std::array<Real, 3>& half) {
  return id < set.triangles() ? overlaps<Real>(set[id], center, half)
                              : overlaps<Real>(set.quadric(id), center, half);
}
[[nodiscard]] inline bool overlaps(const TriangleSet& set, std::uint32_t id, const glm::dvec3& center,
                                   const glm::dvec3& half) {
  return overlaps<double>(set, id, {center.x, center.y, center.z}, {half.x, half.y, half.z});
}

/// The extent of a primitive along one axis.
template <class Real>
struct Extent {
  Real lo;
  Real hi;
};
template <class Real>
[[nodiscard]] inline Extent<Real> extent_of(const TriangleSet& set, std::uint32_t id, std::size_t axis) {
  using std::max;
  using std::min;
  if (id < set.triangles()) {
    const TriangleCorners& t = set[id];
    return {min(min(Real(t[axis]), Real(t[3 + axis])), Real(t[6 + axis])),
            max(max(Real(t[axis]), Real(t[3 + axis])), Real(t[6 + axis]))};
  }
  return {Real(set.quadric(id).lo[axis]), Real(set.quadric(id).hi[axis])};
}

}  // namespace marti::accel
