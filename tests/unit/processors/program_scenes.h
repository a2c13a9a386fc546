// Small scenes built by hand, and their rendering in one call.
#pragma once

#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include <glm/geometric.hpp>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "scenes/scene.h"

namespace marti::processors::test {

/// A scene with its triangles and a structure over them.
struct Built {
  scenes::Scene scene;
  std::shared_ptr<const accel::TriangleSet> triangles;
  std::unique_ptr<accel::Structure> structure;

  explicit Built(scenes::Scene s, std::string_view kind = "none")
      : scene(std::move(s)),
        triangles(std::make_shared<const accel::TriangleSet>(scene)),
        structure(accel::make_structure(kind, triangles)) {}

  [[nodiscard]] program::Frame render(const program::RenderOptions& options, unsigned threads = 1) const {
    return processors::program::render(scene, *triangles, *structure, options, threads);
  }
};

/// Adds the quadrilateral a b c d, whose outside is where its corners turn counter-clockwise.
inline void add_quad(scenes::Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                     const glm::dvec3& d, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c, d});
  const auto polygon = static_cast<std::uint32_t>(scene.polygons++);
  scene.triangles.push_back({{first, first + 1, first + 2}, material, polygon});
  scene.triangles.push_back({{first, first + 2, first + 3}, material, polygon});
}

/// The square |x|, |y| <= half at height z, facing up.
inline void add_floor(scenes::Scene& scene, double z, double half, std::uint32_t material) {
  add_quad(scene, {-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}, material);
}
/// The square |x|, |y| <= half at height z, facing down.
inline void add_ceiling(scenes::Scene& scene, double z, double half, std::uint32_t material) {
  add_quad(scene, {-half, half, z}, {half, half, z}, {half, -half, z}, {-half, -half, z}, material);
}

/// An empty scene seen from (0, 0, height) straight down, x to the right.
inline scenes::Scene looking_down(double height) {
  scenes::Scene scene;
  scene.camera.eye = {0.0, 0.0, height};
  scene.camera.at = {0.0, 0.0, 0.0};
  scene.camera.up = {0.0, 1.0, 0.0};
  return scene;
}

/// One pixel: the ray through the middle of the view.
inline program::RenderOptions one_pixel(std::uint32_t max_depth = 1) {
  return {.width = 1, .height = 1, .max_depth = max_depth};
}

inline bool same_bytes(const program::Image& a, const program::Image& b) {
  return a.width == b.width && a.height == b.height &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(glm::vec3)) == 0;
}

}  // namespace marti::processors::test
