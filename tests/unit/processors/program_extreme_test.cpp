// Images of scenes that doubles or floats can hardly hold: very small and very large ones, and triangles
// without area.
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "program_scenes.h"

namespace marti::processors {

using namespace program;

namespace {

/// Mirrors, glass and matt triangles around the origin, of all shapes down to slivers, and two spheres. A
/// directional light: the colours do not depend on the unit of length.
scenes::Scene mixed_scene() {
  scenes::Scene scene;
  scene.camera.eye = {2.0, 3.0, 4.0};
  scene.camera.at = {0.0, 0.0, 0.0};
  scene.ambient = {0.1, 0.1, 0.1};
  scene.background = {0.2, 0.3, 0.4};
  scene.materials.resize(3);
  scene.materials[1].reflection = 0.8;
  scene.materials[2].transmission = 0.7;
  scene.materials[2].ior = 1.5;
  scenes::Light& light = scene.lights.emplace_back();
  light.kind = scenes::LightKind::directional;
  light.direction = glm::normalize(glm::dvec3(-1.0, -2.0, -3.0));
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto point = [&] {
    const double x = unit(random);
    const double y = unit(random);
    return glm::dvec3(x, y, unit(random));
  };
  for (std::uint32_t i = 0; i < 60; ++i) {
    const glm::dvec3 a = point();
    const glm::dvec3 b = a + 0.8 * point();
    const double height = i % 3 == 0 ? 1e-5 : 0.6;
    scene.positions.insert(scene.positions.end(), {a, b, 0.5 * (a + b) + height * point()});
    scene.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, i % 3, i});
  }
  scene.quadrics.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    scene.quadrics[i].base = {i == 0 ? 0.5 : -0.5, 0.25, 0.5};
    scene.quadrics[i].tip = scene.quadrics[i].base;
    scene.quadrics[i].radius = 0.375;
    scene.quadrics[i].material = 1;
  }
  return scene;
}

scenes::Scene times(scenes::Scene scene, double factor) {
  for (glm::dvec3& position : scene.positions) {
    position *= factor;
  }
  for (scenes::Quadric& quadric : scene.quadrics) {
    quadric.base *= factor;
    quadric.tip *= factor;
    quadric.radius *= factor;
  }
  scene.camera.eye *= factor;
  return scene;
}

/// Adds three corners of an oblique line through the middle of the view, as a mirror.
void add_line(scenes::Scene& scene, const glm::dvec3& d) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {-d, d, glm::dvec3(0.0)});
  scene.triangles.push_back({{first, first + 1, first + 2}, 1, first});
}

Image image_of(const scenes::Scene& scene, bool floats) {
  return test::Built(scene, "octree")
      .render({.width = 33, .height = 33, .max_depth = 3, .floats = floats})
      .image;
}

TEST(ExtremeScenes, TheUnitOfLengthDoesNotChangeTheImage) {
  for (const bool floats : {false, true}) {
    const Image image = image_of(mixed_scene(), floats);
    const std::vector<int> exponents =
        floats ? std::vector<int>{-36, -20, 31, 36} : std::vector<int>{-295, -265, -100, 98};
    for (const int exponent : exponents) {
      EXPECT_TRUE(test::same_bytes(image_of(times(mixed_scene(), std::ldexp(1.0, exponent)), floats), image))
          << exponent << (floats ? " in floats" : "");
    }
  }
}

TEST(ExtremeScenes, TrianglesWithoutAreaAreNotSeen) {
  const Image image = image_of(mixed_scene(), false);
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  scenes::Scene scene = mixed_scene();
  for (int i = 0; i < 100; ++i) {
    const double x = unit(random);
    const double y = unit(random);
    add_line(scene, {x, y, unit(random)});
  }
  EXPECT_TRUE(test::same_bytes(image_of(scene, false), image));
  // In floats a ray may meet one; it then faces the viewer, and its colour is a number.
  for (const glm::vec3& color : image_of(scene, true).pixels) {
    EXPECT_TRUE(std::isfinite(color.x) && std::isfinite(color.y) && std::isfinite(color.z));
  }
}

}  // namespace
}  // namespace marti::processors
