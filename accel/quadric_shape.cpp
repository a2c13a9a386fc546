#include "accel/quadric_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "scenes/scene.h"

namespace marti::accel {

QuadricShape shape_of(const scenes::Quadric& quadric) {
  QuadricShape shape;
  const scenes::Bounds bounds = scenes::bounds_of(quadric);
  if (quadric.kind == scenes::QuadricKind::sphere) {
    shape.radius = quadric.radius;
    shape.reach = quadric.radius;
    shape.center = {quadric.base.x, quadric.base.y, quadric.base.z};
  } else {
    shape.kind = PrimitiveKind::cone;
    const glm::dvec3 axis = quadric.tip - quadric.base;
    const double height = std::hypot(axis.x, axis.y, axis.z);
    const double end_radius = quadric.end_radius();
    shape.half = 0.5 * height;
    shape.radius = 0.5 * quadric.radius + 0.5 * end_radius;
    shape.slope = (end_radius - quadric.radius) / height;
    shape.cosine = 1.0 / std::hypot(1.0, shape.slope);
    // A quarter more than needed, because the kernel uses it for early rejection.
    shape.reach = 1.25 * std::hypot(shape.half, std::max(quadric.radius, end_radius));
    for (std::size_t a = 0; a < 3; ++a) {
      const auto k = static_cast<int>(a);
      shape.center[a] = 0.5 * quadric.base[k] + 0.5 * quadric.tip[k];
      shape.axis[a] = axis[k] / height;
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const auto k = static_cast<int>(a);
    const double rounding = 0x1p-48 * shape.reach + 0x1p-51 * std::abs(shape.center[a]);
    shape.lo[a] = bounds.lo[k] - rounding;
    shape.hi[a] = bounds.hi[k] + rounding;
  }
  return shape;
}

}  // namespace marti::accel
