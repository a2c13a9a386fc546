// Where a scene's origin lies, how large it is, whether it is mirrored and which way it is turned changes no
// count of rays. Lights in the plane of a surface are the hard ones: their cosine is 0, or what rounding
// makes of it.
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "processors/program/render.h"
#include "program_scenes.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

/// A turn or mirroring about the origin, then a scale, then a move.
struct Placement {
  std::string name;
  std::array<glm::dvec3, 3> axes = {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
  double scale = 1.0;
  glm::dvec3 move{0.0};

  [[nodiscard]] glm::dvec3 turned(const glm::dvec3& v) const {
    return axes[0] * v.x + axes[1] * v.y + axes[2] * v.z;
  }
  [[nodiscard]] glm::dvec3 placed(const glm::dvec3& v) const { return turned(v) * scale + move; }
};

scenes::Scene placed(scenes::Scene scene, const Placement& placement) {
  for (glm::dvec3& position : scene.positions) {
    position = placement.placed(position);
  }
  for (glm::dvec3& normal : scene.normals) {
    normal = placement.turned(normal);
  }
  for (scenes::Quadric& quadric : scene.quadrics) {
    quadric.base = placement.placed(quadric.base);
    quadric.radius *= placement.scale;
  }
  for (scenes::Light& light : scene.lights) {
    light.position = placement.placed(light.position);
    light.direction = glm::normalize(placement.turned(light.direction));
    light.range *= placement.scale;
    if (light.inverse_square) {
      light.color *= placement.scale * placement.scale;
    }
  }
  scene.camera.eye = placement.placed(scene.camera.eye);
  scene.camera.at = placement.placed(scene.camera.at);
  scene.camera.up = placement.turned(scene.camera.up);
  return scene;
}

/// A floor under two blocks, seen from above at an angle, with lights as `light_it` adds them.
scenes::Scene blocks(const std::function<void(scenes::Scene&)>& light_it) {
  scenes::Scene scene;
  scene.camera.eye = {2.3, -4.1, 3.7};
  scene.camera.at = {0.1, 0.2, 0.3};
  scene.camera.up = {0.0, 0.0, 1.0};
  scene.camera.vertical_fov = 0.9;
  scene.materials.emplace_back();
  test::add_floor(scene, 0.0, 4.0, 0);
  for (const glm::dvec3 at : {glm::dvec3(-1.0, 0.5, 0.0), glm::dvec3(0.75, -0.25, 0.0)}) {
    const auto corner = [&](int x, int y, int z) { return at + glm::dvec3(x, y, 1.25 * z) * 0.8; };
    test::add_quad(scene, corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1), 0);
    test::add_quad(scene, corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1), 0);
    test::add_quad(scene, corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1), 0);
    test::add_quad(scene, corner(1, 1, 0), corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), 0);
    test::add_quad(scene, corner(0, 1, 0), corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), 0);
  }
  light_it(scene);
  return scene;
}

void add_emitter(scenes::Scene& scene, double height) {
  scenes::Material& panel = scene.materials.emplace_back();
  panel.emission = glm::dvec3(4.0);
  const auto material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  test::add_quad(scene, {-0.5, -0.5, height}, {0.5, -0.5, height}, {0.5, 0.5, height}, {-0.5, 0.5, height},
                 material);
}

/// Scenes of all kinds of light, one of each in the plane of something.
std::vector<std::pair<std::string, scenes::Scene>> scenes_of_all_lights() {
  std::vector<std::pair<std::string, scenes::Scene>> all;
  all.emplace_back("point light", blocks([](scenes::Scene& scene) {
                     scene.lights.emplace_back().position = {1.1, -2.3, 3.1};
                   }));
  all.emplace_back("point light in a plane", blocks([](scenes::Scene& scene) {
                     scene.lights.emplace_back().position = {-3.0, 3.0, 0.0};
                   }));
  all.emplace_back("directional light along a plane", blocks([](scenes::Scene& scene) {
                     scenes::Light& light = scene.lights.emplace_back();
                     light.kind = scenes::LightKind::directional;
                     light.direction = glm::normalize(glm::dvec3(1.0, 2.0, 0.0));
                   }));
  all.emplace_back("spot", blocks([](scenes::Scene& scene) {
                     scenes::Light& light = scene.lights.emplace_back();
                     light.kind = scenes::LightKind::spot;
                     light.position = {1.3, -1.7, 4.1};
                     light.direction = glm::normalize(glm::dvec3(-1.0, 1.5, -4.0));
                     light.inverse_square = true;
                     light.range = 20.0;
                     light.color = glm::dvec3(30.0);
                   }));
  all.emplace_back("emitter on the floor", blocks([](scenes::Scene& scene) { add_emitter(scene, 0.0); }));
  all.emplace_back("emitter above", blocks([](scenes::Scene& scene) { add_emitter(scene, 2.0); }));
  all.emplace_back("all together", blocks([](scenes::Scene& scene) {
                     for (const auto kind : {scenes::LightKind::point, scenes::LightKind::directional,
                                             scenes::LightKind::spot}) {
                       scenes::Light& light = scene.lights.emplace_back();
                       light.kind = kind;
                       light.position = {-1.2, -3.0, 2.9};
                       light.direction = glm::normalize(glm::dvec3(1.0, 2.0, -2.0));
                       light.inverse_square = kind != scenes::LightKind::directional;
                     }
                     add_emitter(scene, 2.5);
                   }));
  return all;
}

RayCounts counts(const scenes::Scene& scene, std::uint32_t samples = 2,
                 Integrator integrator = Integrator::path) {
  RenderOptions options{.width = 64, .height = 64, .max_depth = 1};
  options.integrator = integrator;
  if (integrator == Integrator::whitted) {
    options.max_depth = 4;
  }
  options.samples = samples;
  return Built(scene, "bvh").render(options).rays;
}

/// With mirrors and glass, for rays of several bounces that are not drawn by chance.
scenes::Scene shining(scenes::Scene scene) {
  scene.materials[0].reflection = 0.3;
  scene.materials[0].transmission = 0.3;
  scene.materials[0].ior = 1.5;
  return scene;
}

/// All 24 turns that keep the axes.
std::vector<Placement> right_angles() {
  std::vector<Placement> turns;
  for (int first = 0; first < 3; ++first) {
    for (int second = 0; second < 3; ++second) {
      for (int signs = 0; first != second && signs < 4; ++signs) {
        glm::dvec3 x(0.0);
        glm::dvec3 y(0.0);
        x[first] = (signs & 1) == 0 ? 1.0 : -1.0;
        y[second] = (signs & 2) == 0 ? 1.0 : -1.0;
        turns.push_back({.name = "turn " + std::to_string(turns.size()), .axes = {x, y, glm::cross(x, y)}});
      }
    }
  }
  return turns;
}

TEST(MovedScenes, CountsDoNotDependOnOriginScaleOrRightAngles) {
  std::vector<Placement> placements = right_angles();
  placements.push_back({.name = "moved up a little", .move = {0.0, 0.0, 0.1}});
  placements.push_back({.name = "moved", .move = {0.1, -0.3, 0.7}});
  placements.push_back({.name = "moved far", .move = {1000.0, 1000.0, 1000.0}});
  placements.push_back({.name = "small", .scale = 1e-3});
  placements.push_back({.name = "large and moved", .scale = 7.0, .move = {31.0, 0.0, -13.0}});
  for (const auto& [name, scene] : scenes_of_all_lights()) {
    const RayCounts here = counts(scene);
    for (const Placement& placement : placements) {
      const RayCounts there = counts(placed(scene, placement));
      EXPECT_EQ(there.traced, here.traced) << name << ", " << placement.name;
      EXPECT_EQ(there.hit, here.hit) << name << ", " << placement.name;
    }
    if (name == "emitter on the floor") {
      continue;  // rounding decides which of two surfaces in one place a ray hits: one mirrors, one does not
    }
    const RayCounts mirrored = counts(shining(scene), 1, Integrator::whitted);
    for (const Placement& placement : placements) {
      const RayCounts there = counts(placed(shining(scene), placement), 1, Integrator::whitted);
      EXPECT_EQ(there.traced, mirrored.traced) << "mirrors, " << name << ", " << placement.name;
      EXPECT_EQ(there.hit, mirrored.hit) << "mirrors, " << name << ", " << placement.name;
    }
  }
}

// The image is mirrored too, so the points that are drawn for samples, and those on emitters, are others: one
// ray through the middle of each pixel, and lights without area.
TEST(MovedScenes, CountsDoNotDependOnTheMirror) {
  for (const auto& [name, scene] : scenes_of_all_lights()) {
    if (scene.materials.size() > 1) {
      continue;
    }
    const RayCounts here = counts(scene, 1);
    for (int axis = 0; axis < 3; ++axis) {
      Placement mirror;
      mirror.axes[static_cast<std::size_t>(axis)] *= -1.0;
      const RayCounts there = counts(placed(scene, mirror), 1);
      EXPECT_EQ(there.traced, here.traced) << name << ", axis " << axis;
      EXPECT_EQ(there.hit, here.hit) << name << ", axis " << axis;
    }
  }
}

TEST(MovedScenes, ShadowRaysDoNotDependOnTheTurn) {
  constexpr auto shadow = static_cast<std::size_t>(RayKind::shadow);
  for (const auto& [name, scene] : scenes_of_all_lights()) {
    const auto here = static_cast<double>(counts(scene).traced[shadow]);
    for (int turn = 1; turn <= 8; ++turn) {
      const glm::dvec3 x =
          glm::normalize(glm::dvec3(std::cos(turn), std::sin(2.0 * turn), std::sin(3.0 * turn)));
      const glm::dvec3 y = glm::normalize(glm::cross(glm::dvec3(0.3, 0.2, 0.9), x));
      const Placement turned{
          .name = "", .axes = {x, y, glm::cross(x, y)}, .move = glm::dvec3(turn % 2 == 0 ? 1000.0 : 0.0)};
      EXPECT_NEAR(static_cast<double>(counts(placed(scene, turned)).traced[shadow]), here, 0.001 * here)
          << name << ", turn " << turn;
    }
  }
}

}  // namespace
}  // namespace marti::processors
