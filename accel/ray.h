// Rays and hits, in double precision.
#pragma once

#include <cstdint>
#include <limits>

#include <glm/vec3.hpp>

namespace marti::accel {

inline constexpr std::uint32_t no_primitive = 0xffffffffU;

/// The points origin + t * direction with t_min <= t <= t_max. The direction must be finite and not zero but
/// need not be of unit length; t is in units of its length.
struct Ray {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};
  double t_min = 0.0;
  double t_max = std::numeric_limits<double>::infinity();
};

/// The nearest hit: least t, and the lowest primitive id among equal t. `primitive == no_primitive` when the
/// ray hits nothing. u, v, w are the barycentric weights of the triangle's three corners; 0 for primitives
/// other than triangles.
struct Hit {
  double t = std::numeric_limits<double>::infinity();
  std::uint32_t primitive = no_primitive;
  double u = 0.0;
  double v = 0.0;
  double w = 0.0;

  [[nodiscard]] bool found() const { return primitive != no_primitive; }
};

}  // namespace marti::accel
