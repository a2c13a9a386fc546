// A triangle of the scene as its plane and its heights, and whether rays that begin on it are told from its
// neighbours.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include <glm/geometric.hpp>

#include "accel/triangles.h"
#include "processors/program/shading.h"
#include "studies/stability/hostile_rays.h"

namespace marti::studies::stability {

/// A triangle's corners, unit normal and least height, and the height from which on rays begin on the right
/// side of its neighbours in numbers of this kind.
struct FlatTriangle {
  std::array<glm::dvec3, 3> corners;
  glm::dvec3 normal;
  double height = 0.0;
  double sure_height = 0.0;

  template <class Real>
  FlatTriangle(const accel::TriangleSet& triangles, std::uint32_t id, double reach, Real /*kind*/) {
    for (unsigned k = 0; k < 3; ++k) {
      corners[k] = triangles.corner(id, k);
    }
    const glm::dvec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    normal = glm::normalize(across);
    height = glm::length(across) /
             std::max({glm::length(corners[1] - corners[0]), glm::length(corners[2] - corners[1]),
                       glm::length(corners[0] - corners[2])});
    using Vec = processors::program::Vec3<Real>;
    sure_height =
        processors::program::sure_height<Real>({Vec(corners[0]), Vec(corners[1]), Vec(corners[2])}, reach);
  }
  [[nodiscard]] bool is_sure() const { return height >= sure_height; }
  [[nodiscard]] double over(const glm::dvec3& point) const { return glm::dot(normal, point - corners[0]); }
  /// The distance of a point of its plane from the nearest side, negative outside.
  [[nodiscard]] double inside(const glm::dvec3& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (unsigned k = 0; k < 3; ++k) {
      const glm::dvec3 side = glm::normalize(corners[(k + 1) % 3] - corners[k]);
      least = std::min(least, glm::dot(glm::cross(normal, side), point - corners[k]));
    }
    return least;
  }
};

/// How many triangles are so low that in numbers of this kind rounding decides where rays begin that leave
/// them: through those of a closed body rays may escape.
template <class Real>
std::uint64_t low_triangles(const accel::TriangleSet& triangles, Real kind) {
  const double reach = largest(triangles.bounds().hi - triangles.bounds().lo);
  std::uint64_t low = 0;
  for (std::uint32_t id = 0; id < triangles.triangles(); ++id) {
    low += FlatTriangle(triangles, id, reach, kind).is_sure() ? 0U : 1U;
  }
  return low;
}

}  // namespace marti::studies::stability
