// A closed, convex mesh at any place and of any size.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "accel/triangles.h"
#include "scenes/scene.h"
#include "tests/contract/hostile.h"
#include "tests/support/icosphere.h"

namespace marti::tests {

/// The unit sphere of 20 * 4^times triangles, times `size`, at (offset, -offset, offset / 2).
struct PlacedSphere {
  Icosphere sphere;
  glm::dvec3 center;
  double size;
  scenes::Scene scene;

  PlacedSphere(int times, double offset, double scale)
      : sphere(times), center(offset, -offset, 0.5 * offset), size(scale) {
    for (const glm::dvec3& v : sphere.vertices) {
      scene.positions.push_back(center + size * v);
    }
    for (const auto& face : sphere.faces) {
      scene.triangles.push_back({face, 0, 0});
    }
    scene.materials.emplace_back();
  }

  /// A ray from inside at a vertex, an edge or a face, by turns.
  [[nodiscard]] accel::Ray from_inside(Random& random, std::uint32_t k) const {
    accel::Ray ray;
    ray.origin = center + 0.9 * size * random.unit() * random.direction();
    const auto& face = sphere.faces[random.below(static_cast<std::uint32_t>(sphere.faces.size()))];
    const std::uint32_t first = random.below(3);
    const glm::dvec3 a = scene.positions[face[first]];
    const glm::dvec3 b = scene.positions[face[(first + 1) % 3]];
    const glm::dvec3 c = scene.positions[face[(first + 2) % 3]];
    const double along = k % 3 == 0 ? 0.0 : random.unit();
    const double across = k % 3 == 2 ? random.unit() : 0.0;
    ray.direction = a + along * ((b - a) + across * (c - b)) - ray.origin;
    return ray;
  }
};

}  // namespace marti::tests
