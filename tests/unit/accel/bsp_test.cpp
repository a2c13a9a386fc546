#include "accel/bsp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "accel/octree.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/unit/accel/walk_check.h"

namespace marti::tests {
namespace {

using accel::Bsp;
using accel::BspOptions;
using accel::Octree;
using accel::TopologyNode;
using accel::TriangleCorners;

/// The boxes of all nodes, from the topology alone.
std::vector<scenes::Bounds> boxes_of(const Bsp& bsp) {
  const accel::Topology& topology = bsp.topology();
  std::vector<scenes::Bounds> boxes(topology.nodes.size());
  boxes[0] = bsp.bounds();
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    const TopologyNode& node = topology.nodes[n];
    for (std::uint32_t child = 0; !node.leaf && child < 2; ++child) {
      scenes::Bounds& box = boxes[node.first + child];
      box = boxes[n];
      const int axis = (node.level - 1) % 3;
      (child != 0 ? box.lo : box.hi)[axis] = 0.5 * (box.lo[axis] + box.hi[axis]);
    }
  }
  return boxes;
}

TEST(Bsp, NodesAreBreadthFirstAndCounted) {
  const Bsp bsp = Bsp::build(set_of(hostile_soup(0.0, 1)), {4, 5});
  std::uint32_t next_child = 1;
  std::uint32_t next_entry = 0;
  std::vector<accel::LevelStatistics> levels(bsp.levels().size());
  ASSERT_EQ(levels.size(), 13U) << "five levels of the octree";
  for (const TopologyNode& node : bsp.topology().nodes) {
    accel::LevelStatistics& level = levels.at(node.level - 1U);
    if (!node.leaf) {
      ++level.branches;
      ASSERT_EQ(node.first, next_child);
      ASSERT_EQ(node.count, 2U);
      ASSERT_EQ(bsp.topology().nodes.at(node.first).level, node.level + 1);
      ASSERT_EQ(bsp.topology().nodes.at(node.first + 1).level, node.level + 1);
      next_child += 2;
      continue;
    }
    ++level.leaves;
    level.entries += node.count;
    level.empty_leaves += node.count == 0 ? 1U : 0U;
    level.overfull_leaves += node.count > 4 ? 1U : 0U;
    ASSERT_EQ(node.first, next_entry);
    next_entry += node.count;
  }
  EXPECT_EQ(next_child, bsp.topology().nodes.size());
  EXPECT_EQ(next_entry, bsp.topology().entries.size());
  for (std::size_t l = 0; l < levels.size(); ++l) {
    EXPECT_EQ(levels[l].branches, bsp.levels()[l].branches);
    EXPECT_EQ(levels[l].leaves, bsp.levels()[l].leaves);
    EXPECT_EQ(levels[l].empty_leaves, bsp.levels()[l].empty_leaves);
    EXPECT_EQ(levels[l].entries, bsp.levels()[l].entries);
    EXPECT_EQ(levels[l].overfull_leaves, bsp.levels()[l].overfull_leaves);
  }
}

TEST(Bsp, LeavesListWhatMeetsThem) {
  for (const double offset : {0.0, 1e6}) {
    const Bsp bsp = Bsp::build(set_of(hostile_soup(offset, 2)), {6, 5});
    check_lists(bsp, boxes_of(bsp));
  }
}

TEST(Bsp, WalksFrontToBackThroughTheLeavesOnTheRay) {
  const Bsp bsp = Bsp::build(set_of(hostile_soup(0.0, 4)), {3, 5});
  EXPECT_GT(check_walks(bsp, boxes_of(bsp), 2), 20000U);
}

TEST(Bsp, CountingChangesNothing) { check_counting(Bsp::build(set_of(hostile_soup(0.0, 8)), {5, 9})); }

// Where both trees split all they can, three levels of one are a level of the other, list for list.
TEST(Bsp, ThreeLevelsMakeOneOfTheOctree) {
  const auto triangles = set_of(hostile_soup(0.0, 3));
  const Bsp bsp = Bsp::build(triangles, {1, 4});
  const Octree octree = Octree::build(triangles, {1, 4});
  const auto sizes = [](const accel::Topology& topology, std::uint8_t level) {
    std::vector<std::uint32_t> all;
    for (const TopologyNode& node : topology.nodes) {
      if (node.leaf && node.level == level && node.count > 1) {
        all.push_back(node.count);
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_GT(sizes(octree.topology(), 4).size(), 50U);
  EXPECT_EQ(sizes(bsp.topology(), 10), sizes(octree.topology(), 4));
}

TEST(Bsp, CoincidentTrianglesDoNotMultiply) {
  const Bsp bsp = Bsp::build(
      set_of(std::vector<TriangleCorners>(10000, corners({-1, -1, -1}, {1, 0.3, 0.2}, {0.1, 1, 1}))));
  EXPECT_LT(bsp.topology().entries.size(), 40U * 10000U);
}

TEST(Bsp, RefusesOptionsOutOfRange) {
  const auto triangles = set_of(hostile_soup(0.0, 5));
  EXPECT_THROW((void)Bsp::build(triangles, {0, 12}), sim::UserError);
  EXPECT_THROW((void)Bsp::build(triangles, {8, 0}), sim::UserError);
  EXPECT_THROW((void)Bsp::build(triangles, {8, 22}), sim::UserError);
  EXPECT_THROW((void)Bsp::build(triangles, {8, 12, 0}), sim::UserError);
  EXPECT_NO_THROW((void)Bsp::build(triangles, {1, 21, 1}));
}

}  // namespace
}  // namespace marti::tests
