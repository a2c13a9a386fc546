// Levels, rules and lazily built trees: hand-made counts, and real trees against second ways of counting.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "processors/program/vector.h"
#include "scenes/procedural.h"
#include "studies/paper/level_counts.h"

namespace marti::tests {
namespace {

using studies::paper::bytes_of;
using studies::paper::count_lazy_levels;
using studies::paper::count_levels;
using studies::paper::LevelCount;
using studies::paper::rule_level;

LevelCount level(std::uint64_t branches, std::uint64_t leaves, std::uint64_t partial = 0) {
  LevelCount count;
  count.branches = branches;
  count.leaves = leaves;
  count.partial = partial;
  return count;
}

TEST(Rules, StopAtTheFirstLevelWithEnoughLeaves) {
  const std::vector<LevelCount> levels = {level(1, 0), level(4, 4), level(2, 30), level(1, 15), level(0, 8)};
  EXPECT_EQ(rule_level(levels, 0.5), 2U);
  EXPECT_EQ(rule_level(levels, 1.0), 3U) << "as many leaves as others are not more";
  EXPECT_EQ(rule_level(levels, 14.0), 3U);
  EXPECT_EQ(rule_level(levels, 15.0), 5U);
  EXPECT_EQ(rule_level(levels, 1e6), 5U) << "a level of leaves only exceeds every multiple";
  EXPECT_EQ(rule_level(std::vector{level(1, 0), level(8, 0)}, 0.0), std::nullopt);
  EXPECT_EQ(rule_level({}, 3.0), std::nullopt);
  // A node that is yet to be divided weighs as much as one that has been.
  EXPECT_EQ(rule_level(std::vector{level(1, 0), level(0, 9, 3)}, 3.0), std::nullopt);
  EXPECT_EQ(rule_level(std::vector{level(1, 0), level(0, 10, 3)}, 3.0), 2U);
}

TEST(Rules, RatioOfLeaves) {
  EXPECT_EQ(level(2, 3, 2).leaf_ratio(), 0.75);
  EXPECT_EQ(level(0, 3).leaf_ratio(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(level(0, 0).leaf_ratio(), std::nullopt);
}

// Ten entries at the root, which is divided into seven leaves and a branch; that into eight leaves.
accel::Topology two_branches() {
  accel::Topology topology;
  topology.nodes.push_back({1, 8, 1, false});
  for (std::uint32_t i = 0; i < 7; ++i) {
    topology.nodes.push_back({i, 1, 2, true});
  }
  topology.nodes.push_back({9, 8, 2, false});
  for (std::uint32_t i = 0; i < 8; ++i) {
    topology.nodes.push_back({7 + i, 1, 3, true});
  }
  topology.entries.assign(15, 0);
  topology.work.assign(17, {});
  topology.work[0].listed = 10;
  topology.work[8].listed = 5;
  return topology;
}

TEST(LazyLevels, KeepsWhatNobodyVisited) {
  const accel::Topology topology = two_branches();
  const memory::LayoutConfig layout;  // 8 bytes a node, 4 an entry
  const std::vector<std::uint8_t> nothing(17, 0);
  const auto untouched = count_lazy_levels(topology, nothing, 1);
  ASSERT_EQ(untouched.size(), 1U);
  EXPECT_EQ(untouched[0].partial, 1U);
  EXPECT_EQ(untouched[0].partial_entries, 10U);
  EXPECT_EQ(bytes_of(untouched, layout), 8U + 40U);

  std::vector<std::uint8_t> root(17, 0);
  root[0] = 1;
  const auto once = count_lazy_levels(topology, root, 1);
  ASSERT_EQ(once.size(), 2U);
  EXPECT_EQ(once[1].leaves, 7U);
  EXPECT_EQ(once[1].partial, 1U);
  EXPECT_EQ(bytes_of(once, layout), 8U * 9U + 4U * (7U + 5U));
  EXPECT_EQ(count_lazy_levels(topology, nothing, 2), once) << "built before or when visited";

  EXPECT_EQ(count_lazy_levels(topology, nothing, 3), count_levels(topology));
  EXPECT_EQ(count_lazy_levels(topology, nothing, 99), count_levels(topology));
}

struct Rendered {
  scenes::Scene scene;
  std::shared_ptr<const accel::TriangleSet> triangles;
  std::unique_ptr<accel::Structure> structure;
  processors::program::Frame frame;
};

Rendered render(std::string_view spec, const processors::program::RenderOptions& options) {
  Rendered result;
  result.scene = scenes::make_procedural(spec);
  result.triangles = std::make_shared<const accel::TriangleSet>(result.scene);
  result.structure = accel::make_structure("octree", result.triangles);
  result.frame = processors::program::render(result.scene, *result.triangles, *result.structure, options);
  return result;
}

struct CountingVisitor {
  const accel::Topology& topology;
  std::vector<std::uint64_t> accesses = std::vector<std::uint64_t>(21, 0);
  std::vector<std::uint64_t> tests = std::vector<std::uint64_t>(21, 0);
  void branch(std::uint32_t node) { ++accesses[topology.nodes[node].level - 1U]; }
  void leaf(std::uint32_t node, std::uint32_t tested, std::uint32_t /*entries*/) {
    ++accesses[topology.nodes[node].level - 1U];
    tests[topology.nodes[node].level - 1U] += tested;
  }
};

TEST(Accesses, AreThoseOfAVisitorThatCounts) {
  const processors::program::RenderOptions options{
      .width = 40, .height = 30, .max_depth = 1, .shadows = false, .record = true};
  const Rendered rendered = render("teapot:5", options);
  const auto& octree = dynamic_cast<const accel::StructureOf<accel::Octree>&>(*rendered.structure).concrete();
  CountingVisitor visitor{octree.topology()};
  const scenes::ImagePlane plane = rendered.scene.camera.image_plane(options.width, options.height);
  for (std::uint32_t y = 0; y < options.height; ++y) {
    for (std::uint32_t x = 0; x < options.width; ++x) {
      using Vec = processors::program::Vec3<double>;
      const Vec direction = processors::program::normalized(
          Vec(plane.corner) + Vec(plane.step_x) * (x + 0.5) + Vec(plane.step_y) * (y + 0.5));
      const accel::Ray ray{plane.origin, {direction.x, direction.y, direction.z}};
      static_cast<void>(octree.closest(ray, visitor));
    }
  }
  const studies::paper::NodeVisits visits = studies::paper::count_visits(*rendered.frame.log);
  ASSERT_EQ(visits.per_level.size(), octree.levels().size());
  for (std::size_t i = 0; i < visits.per_level.size(); ++i) {
    EXPECT_EQ(visits.per_level[i], visitor.accesses[i]) << "level " << i + 1;
    EXPECT_EQ(visits.tests[i], visitor.tests[i]) << "level " << i + 1;
  }
}

TEST(Accesses, AddUpToTheLogsTotals) {
  const processors::program::RenderOptions options{.width = 48, .height = 48, .max_depth = 3, .record = true};
  const Rendered rendered = render("gears:1", options);
  const studies::paper::NodeVisits visits = studies::paper::count_visits(*rendered.frame.log);
  const processors::program::LogTotals totals = processors::program::totals_of(*rendered.frame.log);
  std::uint64_t accesses = 0;
  std::uint64_t tests = 0;
  std::uint64_t distinct = 0;
  for (std::size_t i = 0; i < visits.per_level.size(); ++i) {
    accesses += visits.per_level[i];
    tests += visits.tests[i];
    distinct += visits.distinct[i];
    EXPECT_LE(visits.distinct[i], visits.per_level[i]);
  }
  EXPECT_EQ(accesses, totals.branches + totals.leaves);
  EXPECT_EQ(tests, totals.tests);
  EXPECT_GT(distinct, 100U);
}

TEST(Levels, AreTheStructuresOwnStatistics) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(scenes::make_procedural("teapot:6"));
  const accel::Octree octree = accel::Octree::build(triangles);
  const accel::Bsp bsp = accel::Bsp::build(triangles);
  const auto compare = [](const auto& tree) {
    const std::vector<LevelCount> counted = count_levels(tree.topology());
    ASSERT_EQ(counted.size(), tree.levels().size());
    for (std::size_t i = 0; i < counted.size(); ++i) {
      EXPECT_EQ(counted[i].branches, tree.levels()[i].branches);
      EXPECT_EQ(counted[i].leaves, tree.levels()[i].leaves);
      EXPECT_EQ(counted[i].leaf_entries, tree.levels()[i].entries);
      EXPECT_EQ(counted[i].partial, 0U);
    }
  };
  compare(octree);
  compare(bsp);
}

// Every level more that is built before the frame can only add nodes; what is touched is never missing.
TEST(LazyLevels, GrowWithTheInitialLevel) {
  const processors::program::RenderOptions options{.width = 32, .height = 32, .max_depth = 2, .record = true};
  const Rendered rendered = render("teapot:6:pot", options);
  const accel::Topology& topology = rendered.frame.log->topology;
  const studies::paper::NodeVisits visits = studies::paper::count_visits(*rendered.frame.log);
  std::uint64_t before = 0;
  for (std::uint32_t initial = 1; initial <= 13; ++initial) {
    const auto levels = count_lazy_levels(topology, visits.touched, initial);
    std::uint64_t nodes = 0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      nodes += levels[i].nodes();
      EXPECT_GE(levels[i].nodes(), visits.distinct[i]);
      EXPECT_TRUE(levels[i].partial == 0 || i + 1 >= initial);
    }
    EXPECT_GE(nodes, before);
    before = nodes;
  }
  EXPECT_EQ(before, topology.nodes.size());
}

}  // namespace
}  // namespace marti::tests
