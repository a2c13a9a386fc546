// Frames of scenes whose instances are kept: what is seen is what copies show, and machines of every kind
// replay the log.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "processors/program/log_rules.h"
#include "processors/replay/replay.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "tests/support/random_machine.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

/// A teapot with normals that stands in many places, over a floor.
scenes::Scene many_teapots() {
  scenes::Scene pot = scenes::make_procedural("teapot:2");
  const auto pot_triangles = static_cast<std::uint32_t>(pot.triangles.size());
  scenes::Scene scene;
  scene.camera = pot.camera;
  scene.lights = pot.lights;
  scene.materials = pot.materials;
  scene.materials[0].reflection = 0.3;
  test::add_floor(scene, -1.0, 40.0, 0);
  scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
  const auto floor = static_cast<std::uint32_t>(scene.triangles.size());
  const auto vertices = static_cast<std::uint32_t>(scene.positions.size());
  pot.normals.resize(pot.positions.size(), glm::dvec3(0.0));
  scene.positions.insert(scene.positions.end(), pot.positions.begin(), pot.positions.end());
  scene.normals.insert(scene.normals.end(), pot.normals.begin(), pot.normals.end());
  for (scenes::Triangle triangle : pot.triangles) {
    for (std::uint32_t& vertex : triangle.vertex) {
      vertex += vertices;
    }
    scene.triangles.push_back(triangle);
  }
  scene.meshes = {{0, floor}, {floor, pot_triangles}};
  scene.instances.emplace_back();
  for (int i = 0; i < 25; ++i) {
    const glm::dvec3 axis(0.3, 0.2 * i, 1.0);
    const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), 0.7 * i, glm::normalize(axis)));
    scenes::InstancePlace& place = scene.instances.emplace_back();
    place.mesh = 1;
    place.linear = turn * glm::dmat3(i % 3 == 0 ? -0.4 : 0.4);
    place.linear[1] *= 1.0 + 0.05 * i;
    place.shift = {2.5 * (i % 5 - 2), 2.5 * (i / 5 - 2), 0.2 * (i % 4)};
  }
  scenes::number_instances(scene);
  return scene;
}

TEST(Instances, WhatIsSeenIsWhatCopiesShow) {
  const scenes::Scene scene = many_teapots();
  const scenes::Scene copies = scenes::copied_instances(scene);
  const scenes::Bounds box = scenes::bounds_of(scene);
  const scenes::Bounds box_of_copies = scenes::bounds_of(copies);
  EXPECT_TRUE(box.lo == box_of_copies.lo && box.hi == box_of_copies.hi);
  for (const Integrator integrator : {Integrator::whitted, Integrator::path, Integrator::occlusion}) {
    RenderOptions options{.width = 96, .height = 80, .max_depth = 3, .integrator = integrator};
    options.record = true;
    const Frame kept = Built(scene, "bvh").render(options);
    const Frame copied = Built(copies, "bvh").render(options);
    EXPECT_EQ(fault_of(*kept.log), "");
    EXPECT_EQ(fault_of_order(*kept.log), "");
    EXPECT_LT(kept.log->primitives, copied.log->primitives / 10);
    EXPECT_EQ(kept.rays.traced[0], copied.rays.traced[0]);
    EXPECT_EQ(kept.rays.hit[0], copied.rays.hit[0]);
    EXPECT_GT(kept.rays.hit[0], 4000U);
    // Rounding decides at a few edges what a ray hits.
    std::size_t differ = 0;
    for (std::size_t i = 0; i < kept.image.pixels.size(); ++i) {
      const glm::vec3 off = glm::abs(kept.image.pixels[i] - copied.image.pixels[i]);
      differ += std::max({off.x, off.y, off.z}) > 1e-4F ? 1 : 0;
    }
    EXPECT_LE(differ, kept.image.pixels.size() / 500);
  }
}

// A cube of mirrors, one side six times, seen from inside: no ray that leaves a side hits it again. No camera
// ray goes to an edge, where corners that are turned into their places need not meet.
TEST(Instances, NoRayHitsWhatItLeaves) {
  scenes::Scene scene = test::looking_down(0.3);
  scene.camera.eye = {0.131, 0.077, 0.3};
  scene.materials.resize(1);
  scene.materials[0].reflection = 1.0;
  scene.materials[0].diffuse = 0.0;
  scene.background = {1.0, 0.0, 0.0};
  test::add_quad(scene, {-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, 0);
  scene.meshes = {{0, 2}};
  for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
    scene.instances.push_back(
        {0,
         glm::dmat3(glm::rotate(glm::dmat4(1.0), turn * 3.14159265358979323846, glm::dvec3(1, 0, 0))),
         {}});
  }
  for (const double turn : {0.5, 1.5}) {
    scene.instances.push_back(
        {0,
         glm::dmat3(glm::rotate(glm::dmat4(1.0), turn * 3.14159265358979323846, glm::dvec3(0, 1, 0))),
         {}});
  }
  scenes::number_instances(scene);
  RenderOptions options{.width = 64, .height = 64, .max_depth = 60};
  const Frame frame = Built(scene, "bvh").render(options);
  EXPECT_EQ(frame.rays.hit[0], frame.rays.traced[0]);
  const auto mirror = static_cast<std::size_t>(RayKind::reflection);
  EXPECT_EQ(frame.rays.traced[mirror], 64U * 64U * 59U);
  EXPECT_EQ(frame.rays.hit[mirror], frame.rays.traced[mirror]);
}

TEST(Instances, MachinesOfEveryKindReplayThem) {
  RenderOptions options{.width = 24, .height = 20, .max_depth = 2};
  options.record = true;
  options.entered = true;
  const Frame frame = Built(many_teapots(), "bvh").render(options);
  const accel::Topology& tree = frame.log->topology;
  EXPECT_TRUE(accel::has_instances(tree));
  for (const auto order :
       {memory::NodeOrder::breadth_first, memory::NodeOrder::depth_first, memory::NodeOrder::treelets}) {
    for (const auto kind : {machine::NodeKind::core, machine::NodeKind::simt}) {
      machine::MachineConfig config;
      config.nodes = 3;
      config.kind = kind;
      config.layout.node_order = order;
      config.layout.node_bytes = 256;
      const replay::MachineResult result = replay::replay(*frame.log, config);  // checks the laws
      EXPECT_GT(result.end, 0);
    }
  }
}

TEST(Instances, WhatCannotDealWithThemRefuses) {
  const Built built(many_teapots(), "bvh");
  RenderOptions options{.width = 4, .height = 4};
  options.record = true;
  const Frame frame = built.render(options);
  machine::MachineConfig space;
  space.nodes = 2;
  space.scheme = machine::Scheme::space;
  space.layout.node_bytes = 256;
  EXPECT_NE(marti::test::user_error_of([&] {
              (void)replay::replay(*frame.log, space);
            }).find("lies in all regions"),
            std::string::npos);
  options.order = accel::WalkOrder::breadth_first;
  EXPECT_NE(marti::test::user_error_of([&] { (void)built.render(options); }).find("rt.order"),
            std::string::npos);
  options.order = accel::WalkOrder::depth_first;
  options.meets = true;
  EXPECT_NE(marti::test::user_error_of([&] { (void)built.render(options); }).find("rt.share"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::processors
