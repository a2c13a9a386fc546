#include "scenes/scene.h"

#include <limits>

#include <glm/common.hpp>

namespace marti::scenes {

Bounds::Bounds()
    : lo(std::numeric_limits<double>::infinity()), hi(-std::numeric_limits<double>::infinity()) {}

void Bounds::include(const glm::dvec3& point) {
  lo = glm::min(lo, point);
  hi = glm::max(hi, point);
}

Bounds bounds_of(const Scene& scene) {
  Bounds bounds;
  for (const Triangle& triangle : scene.triangles) {
    for (const std::uint32_t vertex : triangle.vertex) {
      bounds.include(scene.positions[vertex]);
    }
  }
  for (const Quadric& quadric : scene.quadrics) {
    const Bounds own = bounds_of(quadric);
    bounds.include(own.lo);
    bounds.include(own.hi);
  }
  return bounds;
}

}  // namespace marti::scenes
