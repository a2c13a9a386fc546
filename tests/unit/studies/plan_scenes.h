// Scenes for the tests of the plan: made by hand, and at random.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "processors/program/vector.h"
#include "scenes/scene.h"
#include "studies/run/prepared_frame.h"

namespace marti::studies::testing {

/// A frame of a scene that is given, small enough to be rendered a thousand times.
inline keys::FrameConfig small_frame(const std::string& structure = "octree", std::uint32_t side = 8) {
  keys::FrameConfig config;
  config.structure = structure;
  config.structure_options.octree.max_objects = 2;
  config.structure_options.bsp.max_objects = 2;
  config.render.width = side;
  config.render.height = side;
  config.memory = sim::MemoryBudget(std::uint64_t{1} << 30U);
  return config;
}

/// Renders and records a frame of a scene, with a plan of what it does not need.
inline run::FunctionalRun run_planned(const keys::FrameConfig& config, scenes::Scene scene,
                                      scenes::FileUse file = {}) {
  const run::PreparedFrame frame(config, std::move(scene), std::move(file));
  return frame.finish(frame.trace());
}

/// The entry of an item, which the plan must have.
inline run::PlanEntry* find_entry(run::Plan& plan, run::PlanItem item) {
  const auto at = std::ranges::find(plan.entries, item, &run::PlanEntry::item);
  return at == plan.entries.end() ? nullptr : &*at;
}

/// Numbers that are the same on every machine, unlike those of the standard distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits_() % n); }
  double between(double lo, double hi) {
    return lo + (hi - lo) * (static_cast<double>(bits_() >> 11U) * 0x1p-53);
  }
  bool chance(double share) { return between(0.0, 1.0) < share; }
  glm::dvec3 point(double reach) {
    const double x = between(-reach, reach);
    const double y = between(-reach, reach);
    return {x, y, between(-reach, reach)};
  }
  /// One of a few colours, black among them.
  glm::dvec3 color() {
    switch (below(4)) {
      case 0:
        return glm::dvec3(0.0);
      case 1:
        return {1.0, 0.0, 0.0};
      case 2:
        return {0.2, 0.7, 0.9};
      default:
        return glm::dvec3(1.0);
    }
  }
  /// A weight, often none.
  double weight() { return chance(0.5) ? 0.0 : between(0.1, 0.9); }

 private:
  std::mt19937_64 bits_;
};

/// An empty scene seen from the origin along -z, 90 degrees wide.
inline scenes::Scene looking_ahead() {
  scenes::Scene scene;
  scene.camera.eye = glm::dvec3(0.0);
  scene.camera.at = {0.0, 0.0, -1.0};
  scene.camera.vertical_fov = 1.5707963267948966;
  return scene;
}

/// A triangle of its own three vertices; normals and texture coordinates as zero where the scene has some.
inline void add_triangle(scenes::Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                         std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c});
  scene.triangles.push_back(
      {{first, first + 1, first + 2}, material, static_cast<std::uint32_t>(scene.polygons++)});
}

/// A large triangle across the view at depth z (negative: ahead, positive: behind), facing the eye.
inline void add_wall(scenes::Scene& scene, double z, std::uint32_t material) {
  const double side = z < 0.0 ? 1.0 : -1.0;
  add_triangle(scene, {-9.0 * side, -9.0, z}, {9.0 * side, -9.0, z}, {0.0, 12.0, z}, material);
}

inline std::uint32_t add_material(scenes::Scene& scene, const scenes::Material& material = {}) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

inline std::uint32_t add_checker(scenes::Scene& scene) {
  scenes::Texture texture;
  texture.name = "checker";
  texture.width = 2;
  texture.height = 2;
  texture.texels = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 0, 255}};
  scene.textures.push_back(std::move(texture));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

inline void add_light(scenes::Scene& scene, const glm::dvec3& position,
                      const glm::dvec3& color = glm::dvec3(1.0)) {
  scenes::Light light;
  light.position = position;
  light.color = color;
  scene.lights.push_back(light);
}

/// The triangle's own normal, in the operations of the ray tracer.
inline glm::dvec3 own_normal(const scenes::Scene& scene, const scenes::Triangle& triangle) {
  using Vec = processors::program::Vec3<double>;
  const Vec a(scene.positions[triangle.vertex[0]]);
  const Vec own = processors::program::normalized(processors::program::cross(
      Vec(scene.positions[triangle.vertex[1]]) - a, Vec(scene.positions[triangle.vertex[2]]) - a));
  return {own.x, own.y, own.z};
}

inline scenes::Material random_material(Random& random, std::size_t textures) {
  scenes::Material material;
  material.color = random.color();
  material.specular_color = random.color();
  material.emission = random.chance(0.2) ? random.color() : glm::dvec3(0.0);
  material.diffuse = random.weight();
  material.reflection = random.chance(0.25) ? random.weight() : 0.0;
  material.transmission = random.chance(0.2) ? random.weight() : 0.0;
  material.ior = random.between(1.0, 2.0);
  material.highlight = random.chance(0.4) ? random.weight() : 0.0;
  material.shininess = random.between(1.0, 30.0);
  if (textures > 0 && random.chance(0.6)) {
    material.texture = random.below(static_cast<std::uint32_t>(textures));
  }
  return material;
}

inline scenes::Texture random_texture(Random& random) {
  scenes::Texture texture;
  texture.width = 1 + random.below(4);
  texture.height = 1 + random.below(4);
  texture.repeat_u = random.chance(0.5);
  texture.texels.resize(texture.size());
  for (auto& texel : texture.texels) {
    for (std::uint8_t& channel : texel) {
      channel = static_cast<std::uint8_t>(random.below(256));
    }
  }
  return texture;
}

inline scenes::Light random_light(Random& random) {
  scenes::Light light;
  light.kind = static_cast<scenes::LightKind>(random.below(3));
  light.position = random.point(6.0);
  light.direction = glm::normalize(random.point(1.0));
  light.color = random.color();
  light.inverse_square = random.chance(0.5);
  light.range = random.chance(0.3) ? 5.0 : 0.0;
  return light;
}

/// Normals: none, all zero, all the triangles' own, or random ones.
inline void add_random_normals(Random& random, scenes::Scene& scene) {
  const std::uint32_t which = random.below(4);
  if (which == 0) {
    return;
  }
  scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
  for (const scenes::Triangle& triangle : scene.triangles) {
    for (const std::uint32_t vertex : triangle.vertex) {
      if (which == 2 || (which == 3 && random.chance(0.3))) {
        scene.normals[vertex] = own_normal(scene, triangle) * (random.chance(0.5) ? 1.0 : -1.0);
      } else if (which == 3) {
        scene.normals[vertex] = glm::normalize(random.point(1.0));
      }
    }
  }
}

/// Up to 24 triangles and a few spheres all around the eye, materials, lights, textures, normals.
inline scenes::Scene random_scene(Random& random) {
  scenes::Scene scene = looking_ahead();
  for (std::uint32_t left = random.below(3); left > 0; --left) {
    scene.textures.push_back(random_texture(random));
  }
  for (std::uint32_t left = 1 + random.below(4); left > 0; --left) {
    add_material(scene, random_material(random, scene.textures.size()));
  }
  const auto materials = static_cast<std::uint32_t>(scene.materials.size());
  // Some scenes keep each material to its own side of the eye.
  const bool sided = random.chance(0.5);
  for (std::uint32_t left = 2 + random.below(22); left > 0; --left) {
    const std::uint32_t material = random.below(materials);
    glm::dvec3 center = random.point(5.0);
    center.z = sided && material % 2 == 0 ? std::abs(center.z) + 3.0 : center.z;
    const glm::dvec3 a = center + random.point(2.0);
    const glm::dvec3 b = center + random.point(2.0);
    add_triangle(scene, a, b, center + random.point(2.0), material);
  }
  add_random_normals(random, scene);
  if (random.chance(0.6)) {
    for (std::size_t i = 0; i < scene.positions.size(); ++i) {
      const double u = random.between(-1.0, 2.0);
      scene.uvs.emplace_back(u, random.between(-1.0, 2.0));
    }
  }
  for (std::uint32_t left = random.chance(0.3) ? random.below(3) : 0; left > 0; --left) {
    scenes::Quadric sphere;
    sphere.kind = scenes::QuadricKind::sphere;
    sphere.base = random.point(5.0);
    sphere.radius = random.between(0.2, 1.0);
    sphere.material = random.below(materials);
    scene.quadrics.push_back(sphere);
  }
  for (std::uint32_t left = random.below(4); left > 0; --left) {
    scene.lights.push_back(random_light(random));
  }
  scene.ambient = random.chance(0.5) ? glm::dvec3(0.1) : glm::dvec3(0.0);
  scene.background = random.color();
  return scene;
}

inline keys::FrameConfig random_frame(Random& random, const std::string& structure) {
  keys::FrameConfig config = small_frame(structure);
  config.render.max_depth = 1 + random.below(4);
  config.render.shadows = random.chance(0.8);
  config.render.mailboxes = random.chance(0.3);
  config.render.min_weight = random.chance(0.3) ? 0.1 : 0.0;
  config.render.samples = random.chance(0.3) ? 1 + random.below(4) : 1;
  if (random.chance(0.3)) {
    config.render.integrator = processors::program::Integrator::path;
    config.render.min_weight = 0.0;
  }
  return config;
}

}  // namespace marti::studies::testing
