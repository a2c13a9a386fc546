#include "accel/octree.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "accel/box_overlap.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/support/long_tests.h"
#include "tests/unit/accel/walk_check.h"

namespace marti::tests {
namespace {

using accel::Counted;
using accel::Hit;
using accel::Octree;
using accel::OctreeOptions;
using accel::Ray;
using accel::Topology;
using accel::TopologyNode;
using accel::TriangleCorners;
using accel::TriangleSet;

/// The boxes of all nodes, from the topology alone.
std::vector<scenes::Bounds> boxes_of(const Octree& octree) {
  const Topology& topology = octree.topology();
  std::vector<scenes::Bounds> boxes(topology.nodes.size());
  boxes[0] = octree.bounds();
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    const TopologyNode& node = topology.nodes[n];
    for (std::uint32_t child = 0; !node.leaf && child < 8; ++child) {
      scenes::Bounds& box = boxes[node.first + child];
      box = boxes[n];
      const glm::dvec3 mid = 0.5 * (box.lo + box.hi);
      for (int a = 0; a < 3; ++a) {
        (((child >> a) & 1U) != 0 ? box.lo : box.hi)[a] = mid[a];
      }
    }
  }
  return boxes;
}

TEST(Octree, NodesAreBreadthFirstAndListsAscend) {
  check_numbering(Octree::build(set_of(tests::hostile_soup(0.0, 1)), {4, 8}), 8, 4);
}

// A leaf above the last level has too many triangles only where splitting would separate none of them.
TEST(Octree, OverfullLeavesCouldNotBeSeparated) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 1));
  const Octree octree = Octree::build(triangles, {4, 8});
  const std::vector<scenes::Bounds> boxes = boxes_of(octree);
  int overfull = 0;
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    const TopologyNode& node = octree.topology().nodes[n];
    if (!node.leaf || node.count <= 4 || node.level == 8) {
      continue;
    }
    ++overfull;
    int complete = 0;
    const glm::dvec3 quarter = 0.25 * (boxes[n].hi - boxes[n].lo);
    for (std::uint32_t child = 0; child < 8; ++child) {
      glm::dvec3 center = boxes[n].lo + quarter;
      for (int a = 0; a < 3; ++a) {
        center[a] += ((child >> a) & 1U) != 0 ? 2.0 * quarter[a] : 0.0;
      }
      std::uint32_t met = 0;
      for (std::uint32_t k = 0; k < node.count; ++k) {
        const TriangleCorners& triangle = (*triangles)[octree.topology().entries[node.first + k]];
        met += accel::overlaps(triangle, center, quarter + octree.delta()) ? 1U : 0U;
      }
      EXPECT_TRUE(met == 0 || met == node.count);
      complete += met == node.count ? 1 : 0;
    }
    EXPECT_GE(complete, 2);
  }
  EXPECT_GT(overfull, 0);
}

// Every leaf lists every triangle that meets it, and none that stays more than 2 delta away from it.
TEST(Octree, LeavesListWhatMeetsThem) {
  for (const double offset : {0.0, 1e6}) {
    const Octree octree = Octree::build(set_of(tests::hostile_soup(offset, 2)), {6, 6});
    check_lists(octree, boxes_of(octree));
  }
}

// Front to back, at most four children of a branch, no leaf that the ray does not meet, none left out.
TEST(Octree, WalksFrontToBackThroughTheLeavesOnTheRay) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 4));
  const Octree octree = Octree::build(triangles, {3, 7});
  EXPECT_GT(check_walks(octree, boxes_of(octree), 4), test::cases(20000U));
}

// The walk on vectors and the walk for any scalar take the same steps and find the same hits.
TEST(Octree, CountingChangesNothing) {
  check_counting(Octree::build(set_of(tests::hostile_soup(0.0, 8)), {5, 10}));
}

// Per branch: three averages, as HERO has it, and the comparisons that order the children.
TEST(Octree, ABranchCostsThreeAverages) {
  const auto triangles = set_of({tests::corners({-1, -1, -1}, {-0.9, -1, -1}, {-1, -0.9, -1}),
                                 tests::corners({1, 1, 1}, {0.9, 1, 1}, {1, 0.9, 1})});
  const Octree octree = Octree::build(triangles, {1, 12});
  ASSERT_EQ(octree.topology().nodes.size(), 9U);
  const auto operations = [&](const Octree& tree, const Ray& ray) {
    accel::NullVisitor visitor;
    const accel::OperationCounts before = accel::operation_counts();
    EXPECT_FALSE(tree.closest<Counted>(ray, visitor).found());
    return accel::operation_counts() - before;
  };
  // Through two empty children, against the same ray in a tree of one node that tests both triangles.
  const Ray ray{{-2, 0.5, -0.5}, {1, 0, 0}};
  const Octree leaf = Octree::build(triangles, {2, 12});
  ASSERT_EQ(leaf.topology().nodes.size(), 1U);
  const accel::OperationCounts branch = operations(octree, ray);
  const accel::OperationCounts tests = operations(leaf, ray);
  EXPECT_EQ(branch.add + 2 * 18, tests.add + 3 + 1);        // three averages, one limit
  EXPECT_EQ(branch.multiply + 2 * 12, tests.multiply + 3);  // three halvings
  EXPECT_GT(branch.integer, tests.integer);
}

TEST(Octree, StaysWithinItsEntries) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 5));
  const std::size_t unlimited = Octree::build(triangles, {1, 10}).topology().entries.size();
  std::size_t last = 0;
  for (const std::uint64_t limit : {std::uint64_t{1}, std::uint64_t{1000}, std::uint64_t{10000}}) {
    const Octree octree = Octree::build(triangles, {1, 10, limit});
    // One split may go over by what its eight children list.
    EXPECT_LE(octree.topology().entries.size(), limit + 8 * triangles->size());
    EXPECT_GE(octree.topology().entries.size(), last);
    last = octree.topology().entries.size();
  }
  EXPECT_GT(unlimited, last);
}

TEST(Octree, FlatScenesAreNotCutInTheirPlane) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<TriangleCorners> sheet;
    for (int i = 0; i < 32; ++i) {
      for (int j = 0; j < 32; ++j) {
        const auto at = [&](int x, int y) {
          glm::dvec3 p(0.0);
          p[(axis + 1) % 3] = x / 31.0;
          p[(axis + 2) % 3] = y / 31.0;
          return p;
        };
        sheet.push_back(tests::corners(at(i, j), at(i + 1, j), at(i + 1, j + 1)));
      }
    }
    const Octree octree = Octree::build(set_of(sheet), {4, 21});
    // A quadtree of 1,024 triangles, not an octree of the empty space around them.
    EXPECT_LT(octree.topology().nodes.size(), 8000U);
    EXPECT_LT(octree.topology().entries.size(), 8U * sheet.size());
    EXPECT_GT(octree.bounds().hi[axis], octree.bounds().lo[axis]);
  }
}

TEST(Octree, RefusesOptionsOutOfRange) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 5));
  EXPECT_THROW((void)Octree::build(triangles, {0, 12}), sim::UserError);
  EXPECT_THROW((void)Octree::build(triangles, {8, 0}), sim::UserError);
  EXPECT_THROW((void)Octree::build(triangles, {8, 22}), sim::UserError);
  EXPECT_THROW((void)Octree::build(triangles, {8, 12, 0}), sim::UserError);
  EXPECT_NO_THROW((void)Octree::build(triangles, {1, 21, 1}));
}

}  // namespace
}  // namespace marti::tests
