// Presets, prices, and the table of operation mixes against a new measurement.
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "instance_scene.h"
#include "processors/cost/cost_model.h"
#include "processors/cost/operation_mix.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace program;

namespace {

/// Within 3 %, or a fiftieth of an operation where there is next to none.
void expect_close(const char* step, const OperationMix& measured, const OperationMix& table) {
  const auto close = [&](const char* operation, std::int64_t m, std::int64_t t) {
    EXPECT_LE(std::abs(static_cast<double>(m - t)), std::max(20.0, 0.03 * static_cast<double>(t)))
        << step << ": " << operation << " measured " << m << ", table " << t << " (thousandths)";
  };
  close("add", measured.add, table.add);
  close("multiply", measured.multiply, table.multiply);
  close("divide", measured.divide, table.divide);
  close("square root", measured.square_root, table.square_root);
  close("compare", measured.compare, table.compare);
  close("integer", measured.integer, table.integer);
}

struct Walk {
  accel::Traversal traversal;
  const char* kind;
  accel::BspWalk bsp = accel::BspWalk::recursive;
  accel::BvhNodeKind bvh = accel::BvhNodeKind::eight;
};
constexpr Walk octree_walk{accel::Traversal::octree, "octree"};

constexpr Walk bvh_walk(accel::Traversal traversal, accel::BvhNodeKind node) {
  return {traversal, "bvh", accel::BspWalk::recursive, node};
}

MeasuredMixes measure(const scenes::Scene& scene, const Walk& walk = octree_walk, std::uint32_t side = 128,
                      Integrator integrator = Integrator::whitted) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  accel::StructureOptions options;
  options.octree.max_objects = options.bsp.max_objects = 9;
  options.octree.max_level = options.bsp.max_level = 12;
  options.bsp.walk = walk.bsp;
  options.bvh.node = walk.bvh;
  const auto structure = accel::make_structure(walk.kind, triangles, options);
  EXPECT_EQ(accel::traversal_of(*structure), walk.traversal);
  return measure_operation_mixes(scene, *triangles, *structure,
                                 {.width = side, .height = side, .max_depth = 2, .integrator = integrator});
}

/// The scene under a square that emits light.
scenes::Scene under_a_panel(std::string_view name) {
  scenes::Scene scene = scenes::make_procedural(name);
  scenes::Material& light = scene.materials.emplace_back();
  light.diffuse = 0.0;
  light.emission = glm::dvec3(5.0);
  const auto material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  test::add_quad(scene, {-2.0, 3.0, 8.0}, {2.0, 3.0, 8.0}, {2.0, -1.0, 8.0}, {-2.0, -1.0, 8.0}, material);
  scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
  return scene;
}

void expect_walk_close(const OperationMixes& measured, const OperationMixes& table) {
  expect_close("camera ray", measured.ray[0], table.ray[0]);
  expect_close("shadow ray", measured.ray[1], table.ray[1]);
  expect_close("reflected ray", measured.ray[2], table.ray[2]);
  expect_close("branch", measured.branch, table.branch);
  expect_close("leaf", measured.leaf, table.leaf);
  expect_close("test", measured.test, table.test);
}

class WalkMixes : public ::testing::TestWithParam<Walk> {};

TEST_P(WalkMixes, TheTableIsWhatTheProgramDoes) {
  const Walk& walk = GetParam();
  const OperationMixes& table = operation_mixes(walk.traversal);
  const bool brute = walk.traversal == accel::Traversal::none;
  const MeasuredMixes teapot =
      measure(scenes::make_procedural(brute ? "teapot:4" : "teapot:12"), walk, brute ? 32 : 128);
  expect_walk_close(teapot.mixes, table);
  if (!brute) {
    expect_close("shade", teapot.mixes.shade, table.shade);
    expect_close("light", teapot.mixes.light, table.light);
  }
  EXPECT_EQ(teapot.mixes.pixel, table.pixel);

  const MeasuredMixes paths =
      measure(under_a_panel(brute ? "teapot:4" : "teapot:12"), walk, brute ? 32 : 128, Integrator::path);
  expect_close("scattered ray", paths.mixes.ray[4], table.ray[4]);
  if (!brute) {
    expect_close("shade of a path", paths.mixes.shade, table.path_shade);
    expect_close("light of a path", paths.mixes.light, table.path_light);
  }

  const MeasuredMixes gears =
      measure(scenes::make_procedural(brute ? "gears:1" : "gears:2"), walk, brute ? 16 : 128);
  if (!brute) {
    ASSERT_GT(gears.steps.rays[3], 0U);
  }
  if (gears.steps.rays[3] > 0) {
    expect_close("refracted ray", gears.mixes.ray[3], table.ray[3]);
  }
}
INSTANTIATE_TEST_SUITE_P(
    OperationMixes, WalkMixes,
    ::testing::Values(octree_walk, Walk{accel::Traversal::bsp_recursive, "bsp"},
                      Walk{accel::Traversal::bsp_push_point, "bsp", accel::BspWalk::push_point},
                      Walk{accel::Traversal::grid, "grid"}, Walk{accel::Traversal::none, "none"},
                      bvh_walk(accel::Traversal::bvh_two, accel::BvhNodeKind::two),
                      bvh_walk(accel::Traversal::bvh_four, accel::BvhNodeKind::four),
                      bvh_walk(accel::Traversal::bvh_six, accel::BvhNodeKind::six),
                      bvh_walk(accel::Traversal::bvh_eight, accel::BvhNodeKind::eight),
                      bvh_walk(accel::Traversal::bvh_eight_quantised, accel::BvhNodeKind::eight_quantised)),
    [](const auto& tested) { return std::to_string(tested.index); });

TEST(OperationMixes, CurvedPrimitivesHaveTestsOfTheirOwn) {
  const OperationMixes& table = operation_mixes(accel::Traversal::octree);
  const MeasuredMixes lattice = measure(scenes::make_procedural("lattice:4"));
  ASSERT_GT(lattice.tests[1], 10000U);
  ASSERT_GT(lattice.tests[2], 10000U);
  EXPECT_EQ(lattice.tests[0] + lattice.tests[1] + lattice.tests[2], lattice.steps.tests);
  expect_close("sphere test", lattice.mixes.sphere_test, table.sphere_test);
  expect_close("cone test", lattice.mixes.cone_test, table.cone_test);
}

// All of a ray's way into a mesh is straight-line code but for its start in the mesh, which ends early where
// the ray misses the mesh's own box. Of the operations counted here two products of a matrix and a vector and
// two sums of vectors, 18 multiplications and 18 additions, are the transform; a ray is set up with the
// others.
TEST(OperationMixes, InstancesHaveAStepOfTheirOwn) {
  const scenes::Scene scene = test::many_teapots();
  for (const Walk& walk :
       {bvh_walk(accel::Traversal::bvh_two, accel::BvhNodeKind::two),
        bvh_walk(accel::Traversal::bvh_eight, accel::BvhNodeKind::eight),
        bvh_walk(accel::Traversal::bvh_eight_quantised, accel::BvhNodeKind::eight_quantised)}) {
    const OperationMixes& table = operation_mixes(walk.traversal);
    const MeasuredMixes measured = measure(scene, walk);
    ASSERT_GT(measured.steps.transforms, 10000U);
    expect_close("transform", measured.mixes.transform, table.transform);
    EXPECT_GE(measured.mixes.transform.multiply, 18000);
    EXPECT_GE(measured.mixes.transform.add, 18000);
  }
}

TEST(OperationMixes, TexelsAreStraightLineCode) {
  scenes::Scene scene = test::looking_down(2.0);
  scene.materials.emplace_back().texture = 0;
  test::add_floor(scene, 0.0, 1.0, 0);
  scene.uvs = {{0.0, 1.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 0.0}};
  scenes::Texture& texture = scene.textures.emplace_back();
  texture.width = texture.height = 1;
  texture.texels = {{1, 2, 3, 255}};
  const MeasuredMixes measured = measure(scene);
  ASSERT_GT(measured.steps.texels, 0U);
  EXPECT_EQ(measured.mixes.texel, operation_mixes(accel::Traversal::octree).texel);
}

// The counting render takes exactly the steps of the real one.
void expect_same_steps(const test::Built& built) {
  const RenderOptions options{.width = 32, .height = 32, .max_depth = 4, .record = true};
  const LogTotals real = totals_of(*built.render(options).log);
  const LogTotals counted =
      measure_operation_mixes(built.scene, *built.triangles, *built.structure, options).steps;
  EXPECT_EQ(counted.all_rays(), real.all_rays());
  EXPECT_EQ(counted.branches, real.branches);
  EXPECT_EQ(counted.transforms, real.transforms);
  EXPECT_EQ(counted.leaves, real.leaves);
  EXPECT_EQ(counted.tests, real.tests);
  EXPECT_EQ(counted.shades, real.shades);
  EXPECT_EQ(counted.lights, real.lights);
}
TEST(OperationMixes, CountingChangesNothing) {
  expect_same_steps(test::Built(scenes::make_procedural("gears:2"), "octree"));
  expect_same_steps(test::Built(test::many_teapots(), "bvh"));
}

// The tables of the sources, read again: each preset has a row here, in the order add, multiply, divide,
// square root, compare, integer, load, store.
TEST(CostModel, EveryPresetHasTheCyclesOfItsSource) {
  using Row = std::array<std::int64_t, 8>;
  const std::map<std::string_view, Row> sources = {
      {"unit", {1, 1, 1, 1, 1, 1, 1, 1}},
      // FADD, FMUL, FDIV, FSQRT, FCMP of the MC68882; the rest are conventions.
      {"mc68882-1989", {56, 76, 108, 110, 38, 4, 6, 4}},
      // Latencies of FADDD, FMULD, FDIVD, FSQRTD, FCMPD of the VFP11.
      {"arm1176-2003", {8, 9, 33, 33, 4, 1, 1, 1}},
      // ReleaseAtCycles of WriteF, WriteFMul, FDivSP, FSqrtSP, WriteFCmp, WriteI, WriteLD, WriteST in LLVM's
      // model.
      {"cortex-a510-2021", {1, 1, 10, 9, 1, 1, 1, 1}}};
  EXPECT_EQ(cost_presets().size(), sources.size());
  for (const std::string_view name : cost_presets()) {
    const OperationCycles c = cost_preset(name);
    EXPECT_EQ((Row{c.add, c.multiply, c.divide, c.square_root, c.compare, c.integer, c.load, c.store}),
              sources.at(name))
        << name;
  }
}

TEST(CostModel, AnUnknownPresetIsRefusedWithTheNamesOfTheOthers) {
  const std::string message = marti::test::user_error_of([] { static_cast<void>(cost_preset("mc68000")); });
  for (const std::string_view name : cost_presets()) {
    EXPECT_NE(message.find(name), std::string::npos) << message;
  }
}

TEST(CostModel, OneKindOfOperationIsPricedByItsColumn) {
  const OperationMixes& mixes = operation_mixes(accel::Traversal::octree);
  const RecordWords words;
  OperationCycles only{0, 0, 0, 0, 0, 0, 0, 0};
  only.add = 1000;  // thousandths become cycles
  StepCycles steps = step_cycles(only, words);
  EXPECT_EQ(steps.branch, mixes.branch.add);
  EXPECT_EQ(steps.test, mixes.test.add);
  EXPECT_EQ(steps.transform, mixes.transform.add);
  EXPECT_EQ(steps.sphere_test, mixes.sphere_test.add);
  EXPECT_EQ(steps.cone_test, mixes.cone_test.add);
  EXPECT_EQ(steps.ray[1], mixes.ray[1].add);
  EXPECT_EQ(steps.leaf, 0);
  only = {0, 0, 0, 0, 0, 0, 0, 0};
  only.divide = 1000;
  steps = step_cycles(only, words);
  EXPECT_EQ(steps.shade, mixes.shade.divide);
  EXPECT_EQ(steps.light, mixes.light.divide);
  only.divide = 1;  // halves up
  EXPECT_EQ(step_cycles(only, words).test, (mixes.test.divide + 500) / 1000);
}

TEST(CostModel, EachTraversalIsPricedByItsOwnSteps) {
  OperationCycles only{0, 0, 0, 0, 0, 0, 0, 0};
  only.divide = 1000;
  for (std::size_t t = 0; t < accel::traversals; ++t) {
    const auto traversal = static_cast<accel::Traversal>(t);
    const StepCycles steps = step_cycles(only, {}, traversal);
    EXPECT_EQ(steps.leaf, operation_mixes(traversal).leaf.divide);
    EXPECT_EQ(steps.ray[0], operation_mixes(traversal).ray[0].divide);
    EXPECT_EQ(steps.leaf > 0, traversal == accel::Traversal::bsp_push_point) << "it alone divides at a leaf";
  }
  only = {0, 0, 0, 0, 0, 0, 0, 0};
  only.compare = 1000;
  EXPECT_EQ(step_cycles(only, {}, accel::Traversal::grid).leaf,
            operation_mixes(accel::Traversal::grid).leaf.compare);
  EXPECT_GT(step_cycles(only, {}, accel::Traversal::grid).leaf, 2000);
}

TEST(CostModel, MailboxesTakeTheEntryFromTheTest) {
  const OperationCycles cycles{0, 0, 0, 0, 0, 10, 3, 7};
  const RecordWords words{.node = 2, .entry = 1, .primitive = 12, .material = 16, .texel = 1, .pixel = 4};
  const StepCycles with = step_cycles(cycles, words, accel::Traversal::grid, true);
  const StepCycles without = step_cycles(cycles, words, accel::Traversal::grid, false);
  EXPECT_EQ(with.lookup, (10 + 3) + (10 + 3) + 10) << "the entry, its mailbox, the comparison";
  EXPECT_EQ(with.test + (10 + 3), without.test + 7) << "no entry to fetch, a number to leave";
  EXPECT_EQ(without.lookup, 0);
  EXPECT_EQ(with.leaf, without.leaf);
}

TEST(CostModel, RecordsCostTheirWords) {
  OperationCycles cycles{0, 0, 0, 0, 0, 0, 3, 7};
  RecordWords words{.node = 2,
                    .entry = 1,
                    .primitive = 12,
                    .quadric = 10,
                    .material = 16,
                    .texel = 1,
                    .pixel = 4,
                    .transform = 9};
  const StepCycles steps = step_cycles(cycles, words);
  EXPECT_EQ(steps.branch, 3 * 2);
  EXPECT_EQ(steps.transform, 3 * 9);
  EXPECT_EQ(steps.leaf, 3 * 2);
  EXPECT_EQ(steps.test, 3 * (1 + 12));
  EXPECT_EQ(steps.sphere_test, 3 * (1 + 10));
  EXPECT_EQ(steps.cone_test, 3 * (1 + 10));
  EXPECT_EQ(steps.shade, 3 * 16);
  EXPECT_EQ(steps.light, 0);
  EXPECT_EQ(steps.texel, 3 * 1);
  EXPECT_EQ(steps.pixel, 7 * 4);
  EXPECT_EQ(steps.ray[0], 0);
}

}  // namespace
}  // namespace marti::processors
