// Frames of scenes whose instances are kept: what is seen is what copies show, and machines of every kind
// replay the log.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "instance_scene.h"
#include "processors/program/log_rules.h"
#include "processors/replay/replay.h"
#include "simt_machines.h"
#include "tests/support/random_machine.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

TEST(Instances, WhatIsSeenIsWhatCopiesShow) {
  const scenes::Scene scene = test::many_teapots();
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
  const Frame frame = Built(test::many_teapots(), "bvh").render(options);
  EXPECT_TRUE(accel::has_instances(frame.log->topology));
  EXPECT_TRUE(frame.log->has_entered());
  const LogTotals totals = totals_of(*frame.log);
  EXPECT_GT(totals.transforms, 1000U);
  for (const auto order :
       {memory::NodeOrder::breadth_first, memory::NodeOrder::depth_first, memory::NodeOrder::treelets}) {
    for (const auto kind : {machine::NodeKind::core, machine::NodeKind::simt}) {
      machine::MachineConfig config;
      config.nodes = 3;
      config.kind = kind;
      config.layout.node_order = order;
      config.layout.node_bytes = 256;
      config.cache.cache.line = 64;
      const replay::MachineResult result = replay::replay(*frame.log, config);  // checks the laws
      EXPECT_EQ(static_cast<std::uint64_t>(result.steps().transforms), totals.transforms);
      if (kind == machine::NodeKind::core) {
        // Each lies in a line by itself, and is read once at each visit.
        const auto transform = static_cast<std::size_t>(memory::RecordKind::transform);
        const cost::ReferenceCounts references = result.references();
        EXPECT_EQ(static_cast<std::uint64_t>(references.hits[transform] + references.misses[transform]),
                  totals.transforms);
      }
    }
  }
}

// A ray that visits the root, an instance, the root of its mesh and a leaf with one triangle, for one pixel.
WorkLog one_ray() {
  WorkLog log;
  log.traversal = accel::Traversal::bvh_two;
  log.width = log.height = 1;
  log.primitives = 1;
  log.texture_begin = {0};
  log.topology.nodes = {{1, 1, 1, false}, {2, 1, 2, false, true}, {3, 1, 3, false}, {0, 1, 4, true}};
  log.topology.entries = {0};
  log.rows.resize(1);
  log.rows[0].begin = {0, 5};
  log.rows[0].words = {camera_ray, make_word(Step::branch, 0), make_word(Step::transform, 1),
                       make_word(Step::branch, 2), make_word(Step::leaf, 3)};
  return log;
}

// Loads alone cost something, a cycle each, and each record lies in a line of its own, which misses once.
TEST(Instances, AMachineByHandTakesTheSumOfItsParts) {
  const WorkLog log = one_ray();
  ASSERT_EQ(fault_of(log), "");
  ASSERT_EQ(fault_of_order(log), "");
  machine::MachineConfig config;
  config.nodes = 1;
  config.operations = {0, 0, 0, 0, 0, 0, 1, 0};
  config.pixels = machine::Pixels::collected;
  config.clock = sim::Clock::from_period(10);
  config.layout.node_bytes = 32;
  config.layout.transform_bytes = 60;
  config.layout.record_alignment = config.cache.cache.line = 64;
  config.layout.section_alignment = 64;
  config.host.latency_cycles = 0;
  config.interconnect.kind = memory::InterconnectKind::ideal;
  config.interconnect.clock = sim::Clock::from_period(7);
  config.interconnect.latency_cycles = 100;
  const replay::MachineResult core = replay::replay(log, config);
  // Words of two nodes, of the transform, of a list entry and of a triangle; five lines.
  EXPECT_EQ(core.nodes[0].finish, (2 * 8 + 15 + 1 + 12) * 10 + 5 * core.unloaded_miss);
  EXPECT_EQ(core.unloaded_miss, 700);
  const auto misses = core.references().misses;
  EXPECT_EQ(misses, (std::array<std::int64_t, memory::record_kinds>{2, 1, 1, 1, 0, 0, 0}));

  // A lane that finds its lines where a hit finds them takes a hit for each record, and the tests' cycles.
  machine::MachineConfig simt = test::one_warp(1, 3, 0);
  simt.layout.transform_bytes = simt.layout.primitive_bytes = simt.cache.cache.line;
  simt.rt.box_cycles = 5;
  simt.rt.transform_cycles = 11;
  simt.rt.triangle_cycles = 17;
  const walk::SimtCounts counts = replay::replay(log, simt).simt.nodes.at(0);
  EXPECT_EQ(counts.records, 5);
  EXPECT_EQ(counts.unit_cycles, (3 + 5) + (3 + 11) + (3 + 5) + 3 + (3 + 17));
}

TEST(Instances, WhatCannotDealWithThemRefuses) {
  const Built built(test::many_teapots(), "bvh");
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
