#include "scenes/scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <glm/common.hpp>

#include "sim/error.h"

namespace marti::scenes {

Bounds::Bounds()
    : lo(std::numeric_limits<double>::infinity()), hi(-std::numeric_limits<double>::infinity()) {}

void Bounds::include(const glm::dvec3& point) {
  lo = glm::min(lo, point);
  hi = glm::max(hi, point);
}

HitTriangle hit_triangle(const Scene& scene, std::uint32_t primitive) {
  if (scene.instances.empty()) {
    return {primitive, nullptr};
  }
  const auto behind =
      std::upper_bound(scene.instances.begin(), scene.instances.end(), primitive,
                       [](std::uint32_t id, const InstancePlace& place) { return id < place.first; });
  const InstancePlace& place = *std::prev(behind);
  return {scene.meshes[place.mesh].first + (primitive - place.first), &place};
}

void number_instances(Scene& scene) {
  std::vector<double> reach(scene.meshes.size());  // of each mesh the largest coordinate
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const PrimitiveRange& mesh = scene.meshes[m];
    for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t) {
      for (const std::uint32_t vertex : scene.triangles[t].vertex) {
        const glm::dvec3 size = glm::abs(scene.positions[vertex]);
        reach[m] = std::max({reach[m], size.x, size.y, size.z});
      }
    }
  }
  std::uint64_t next = 0;
  for (InstancePlace& place : scene.instances) {
    place.first = static_cast<std::uint32_t>(next);
    next += scene.meshes[place.mesh].count;
    double farthest = 0.0;
    for (int row = 0; row < 3; ++row) {
      const double turned =
          std::abs(place.linear[0][row]) + std::abs(place.linear[1][row]) + std::abs(place.linear[2][row]);
      farthest = std::max(farthest, turned * reach[place.mesh] + std::abs(place.shift[row]));
    }
    if (!(farthest <= 0x1p300)) {
      throw sim::UserError("an instance of the scene reaches beyond 2^300");
    }
    // A ray's origin is turned back, and the corners of the triangle that it hits are turned: some eight
    // roundings each, and as many of the centres that lie between (accel/instance.h).
    place.rounding = 0x1p-48 * stretch_of(place.linear) * farthest;
    if (next >= 0xffffffffU) {
      throw sim::UserError("the scene's instances have 2^32 - 1 triangles or more");
    }
  }
}

Scene copied_instances(const Scene& scene) {
  Scene copy = scene;
  if (scene.instances.empty()) {
    return copy;
  }
  copy.meshes.clear();
  copy.instances.clear();
  copy.triangles.clear();
  copy.positions.clear();
  copy.normals.clear();
  copy.uvs.clear();
  for (const InstancePlace& place : scene.instances) {
    const PrimitiveRange& mesh = scene.meshes[place.mesh];
    for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t) {
      Triangle& triangle = copy.triangles.emplace_back(scene.triangles[t]);
      if (place.mirrors()) {
        std::swap(triangle.vertex[1], triangle.vertex[2]);
      }
      for (std::uint32_t& vertex : triangle.vertex) {
        const std::uint32_t from = std::exchange(vertex, static_cast<std::uint32_t>(copy.positions.size()));
        copy.positions.push_back(place.of(scene.positions[from]));
        if (!scene.normals.empty()) {
          copy.normals.push_back(place.normal_of(scene.normals[from]));
        }
        if (!scene.uvs.empty()) {
          copy.uvs.push_back(scene.uvs[from]);
        }
      }
    }
  }
  return copy;
}

Bounds bounds_of(const Scene& scene) {
  Bounds bounds;
  if (!scene.instances.empty()) {
    // Vertices that triangles share are turned once.
    std::vector<std::vector<std::uint32_t>> vertices(scene.meshes.size());
    for (const InstancePlace& place : scene.instances) {
      std::vector<std::uint32_t>& used = vertices[place.mesh];
      if (used.empty()) {
        const PrimitiveRange& mesh = scene.meshes[place.mesh];
        for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t) {
          const Triangle& triangle = scene.triangles[t];
          used.insert(used.end(), triangle.vertex.begin(), triangle.vertex.end());
        }
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
      }
      for (const std::uint32_t vertex : used) {
        bounds.include(place.of(scene.positions[vertex]));
      }
    }
    return bounds;
  }
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
