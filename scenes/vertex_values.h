// Internal to scenes/: which positions and normals of files can be used, and what transforms make of normals.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace marti::scenes {

/// Beyond this, products of three differences of coordinates could overflow.
inline constexpr double largest_coordinate = 1e30;

[[nodiscard]] inline bool is_usable(const glm::dvec3& p) {
  return std::abs(p.x) <= largest_coordinate && std::abs(p.y) <= largest_coordinate &&
         std::abs(p.z) <= largest_coordinate;
}

/// Texture coordinates of a file whose v goes up, as Scene::uvs has them; (0, 0) if they are not finite.
[[nodiscard]] inline glm::dvec2 turned_coordinates(double u, double v) {
  const glm::dvec2 uv(u, 1.0 - v);
  return std::isfinite(uv.x) && std::isfinite(uv.y) ? uv : glm::dvec2(0.0);
}

/// A unit vector along n, or zero if n has no direction. One that is of unit length up to rounding stays as
/// it is, so that reading what was written changes no bit.
[[nodiscard]] inline glm::dvec3 unit_or_zero(const glm::dvec3& n) {
  const double length = glm::length(n);
  if (std::abs(length - 1.0) <= 0x1p-50) {
    return n;
  }
  const glm::dvec3 unit = n / length;
  const bool usable = std::isfinite(unit.x) && std::isfinite(unit.y) && std::isfinite(unit.z) &&
                      std::abs(glm::length(unit) - 1.0) < 1e-6;
  return usable ? unit : glm::dvec3(0.0);
}

/// Whether the transform reverses the winding of triangles.
[[nodiscard]] inline bool is_mirroring(const glm::dmat3& m) {
  return glm::dot(m[0], glm::cross(m[1], m[2])) < 0.0;
}

/// The inverse transpose up to a positive factor: the cofactors, negated for a mirroring transform. It needs
/// no division, so singular transforms cause no error.
[[nodiscard]] inline glm::dmat3 normal_transform(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return is_mirroring(m) ? -cofactors : cofactors;
}

}  // namespace marti::scenes
