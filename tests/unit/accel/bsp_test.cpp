#include "accel/bsp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "accel/octree.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/support/long_tests.h"
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
  const Bsp bsp = Bsp::build(set_of(tests::hostile_soup(0.0, 1)), {4, 5});
  EXPECT_EQ(bsp.levels().size(), 13U) << "five levels of the octree";
  check_numbering(bsp, 2, 4);
}

TEST(Bsp, LeavesListWhatMeetsThem) {
  for (const double offset : {0.0, 1e6}) {
    const Bsp bsp = Bsp::build(set_of(tests::hostile_soup(offset, 2)), {6, 5});
    check_lists(bsp, boxes_of(bsp));
  }
}

TEST(Bsp, WalksFrontToBackThroughTheLeavesOnTheRay) {
  const Bsp bsp = Bsp::build(set_of(tests::hostile_soup(0.0, 4)), {3, 5});
  EXPECT_GT(check_walks(bsp, boxes_of(bsp), 2), test::cases(20000U));
}

BspOptions pushing(std::uint32_t max_objects, std::uint32_t max_level) {
  BspOptions options;
  options.max_objects = max_objects;
  options.max_level = max_level;
  options.walk = accel::BspWalk::push_point;
  return options;
}

TEST(Bsp, CountingChangesNothing) {
  check_counting(Bsp::build(set_of(tests::hostile_soup(0.0, 8)), {5, 9}));
  check_counting(Bsp::build(set_of(tests::hostile_soup(0.0, 8)), pushing(5, 9)));
}

/// The leaves of a walk in order, after checking that each was found by a path from the root.
std::vector<std::uint32_t> leaves_of(const Bsp& bsp, const Recorder& recorder) {
  std::vector<std::uint32_t> leaves;
  bool at_root = true;
  std::uint32_t parent = 0;
  for (const Recorder::Visit& visit : recorder.visits) {
    if (at_root) {
      EXPECT_EQ(visit.node, 0U);
    } else {
      const TopologyNode& node = bsp.topology().nodes[parent];
      EXPECT_TRUE(visit.node == node.first || visit.node == node.first + 1);
    }
    parent = visit.node;
    at_root = visit.leaf;
    if (visit.leaf) {
      leaves.push_back(visit.node);
    }
  }
  EXPECT_TRUE(at_root) << "the walk ended on its way";
  return leaves;
}

// Every leaf that the ray crosses for longer than rounding can move it, in order, from the root each time,
// and none twice.
TEST(Bsp, PushedPointsFindTheLeavesOnTheRay) {
  const Bsp bsp = Bsp::build(set_of(tests::hostile_soup(0.0, 4)), pushing(3, 5));
  const std::vector<scenes::Bounds> boxes = boxes_of(bsp);
  RayMaker maker(bsp.triangles(), bsp.bounds(), 6);
  const double margin = 8.0 * bsp.delta();
  std::uint64_t visited = 0;
  for (int k = 0; k < test::cases(6000) && !::testing::Test::HasFailure(); ++k) {
    const accel::Ray ray = maker.make(tests::all_aims[static_cast<std::size_t>(k) % 6]);
    Recorder recorder;
    const accel::Hit hit = bsp.closest(ray, recorder);
    const std::vector<std::uint32_t> leaves = leaves_of(bsp, recorder);
    visited += leaves.size();
    const std::set<std::uint32_t> met(leaves.begin(), leaves.end());
    ASSERT_EQ(met.size(), leaves.size()) << "a leaf was visited twice";
    long double last_in = -std::numeric_limits<long double>::infinity();
    for (const std::uint32_t leaf : leaves) {
      const Inside exact = inside(ray, boxes[leaf], -margin);
      if (exact.in < exact.out) {
        ASSERT_GE(exact.in, last_in) << "not front to back";
        last_in = exact.in;
      }
    }
    each_crossed(bsp.topology(), boxes, ray, -margin, [&](std::uint32_t n, const Inside& on) {
      if (bsp.topology().nodes[n].leaf && (!hit.found() || on.in < hit.t)) {
        ASSERT_TRUE(met.contains(n)) << "a leaf on the ray was left out";
      }
    });
  }
  EXPECT_GT(visited, test::cases(20000U));
}

// Both walks meet the same leaves, except those that a ray only touches.
TEST(Bsp, BothWalksVisitTheSameLeaves) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 4));
  const Bsp recursive = Bsp::build(triangles, {3, 6});
  const Bsp pushed = Bsp::build(triangles, pushing(3, 6));
  RayMaker maker(*triangles, recursive.bounds(), 16);
  std::uint64_t leaves = 0;
  std::uint64_t different = 0;
  for (int k = 0; k < test::cases(20000); ++k) {
    const accel::Ray ray = maker.make(Aim::random);
    Recorder a;
    Recorder b;
    static_cast<void>(recursive.closest(ray, a));
    static_cast<void>(pushed.closest(ray, b));
    std::erase_if(a.visits, [](const Recorder::Visit& visit) { return !visit.leaf; });
    std::erase_if(b.visits, [](const Recorder::Visit& visit) { return !visit.leaf; });
    leaves += a.visits.size();
    different += a.visits == b.visits ? 0U : 1U;
  }
  EXPECT_GT(leaves, test::cases(100000U));
  EXPECT_LE(different, 20U);
}

// The paper's statement for a step, and the further operations of this walk (bsp_push.h says why).
TEST(Bsp, ALeafIsLeftBySixDivisionsSevenAdditionsAndFiveComparisons) {
  struct Marks {
    std::vector<accel::OperationCounts> at_leaf;
    accel::OperationCounts descent;
    std::uint64_t branches = 0;
    bool in_descent = false;
    accel::OperationCounts mark;
    void branch(std::uint32_t /*node*/) {
      if (in_descent) {
        descent += accel::operation_counts() - mark;
      } else if (!at_leaf.empty()) {
        at_leaf.back() = accel::operation_counts() - at_leaf.back();
      }
      ++branches;
      in_descent = true;
      mark = accel::operation_counts();
    }
    void leaf(std::uint32_t /*node*/, std::uint32_t /*tests*/, std::uint32_t /*entries*/) {
      descent += accel::operation_counts() - mark;
      in_descent = false;
      at_leaf.push_back(accel::operation_counts());
    }
  };
  // Triangles without area are listed but never hit, so that leaves have tests but no hits: leave those out.
  std::vector<TriangleCorners> points;
  for (const double x : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) {
      for (const double z : {0.0, 1.0}) {
        points.push_back(tests::corners({x, y, z}, {x, y, z}, {x, y, z}));
      }
    }
  }
  const Bsp bsp = Bsp::build(set_of(points), pushing(1, 2));
  Marks marks;
  const accel::Ray ray{{-0.5, 0.1, 0.2}, {1.0, 0.35, 0.29}};
  ASSERT_FALSE(bsp.closest<accel::Counted>(ray, marks).found());
  ASSERT_GE(marks.at_leaf.size(), 3U);
  marks.at_leaf.pop_back();  // the walk's end
  for (const accel::OperationCounts& step : marks.at_leaf) {
    EXPECT_EQ(step.divide, 6U);
    EXPECT_EQ(step.add, 7U + 2U) << "the paper's, and two coordinates of the point";
    EXPECT_EQ(step.compare, 5U + 1U + 2U) << "the paper's, the end of the walk, two bounds of the point";
    EXPECT_EQ(step.multiply, 2U);
    EXPECT_EQ(step.square_root, 0U);
  }
}

// Where both trees split as far as possible, three levels of the BSP tree equal one of the octree.
TEST(Bsp, ThreeLevelsMakeOneOfTheOctree) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 3));
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

TEST(Bsp, RefusesOptionsOutOfRange) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 5));
  EXPECT_THROW((void)Bsp::build(triangles, {0, 12}), sim::UserError);
  EXPECT_THROW((void)Bsp::build(triangles, {8, 0}), sim::UserError);
  EXPECT_THROW((void)Bsp::build(triangles, {8, 22}), sim::UserError);
  EXPECT_THROW((void)Bsp::build(triangles, {8, 12, 0}), sim::UserError);
  EXPECT_NO_THROW((void)Bsp::build(triangles, {1, 21, 1}));
}

}  // namespace
}  // namespace marti::tests
