#include "accel/octree_build.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "accel/counted.h"
#include "accel/octree.h"
#include "accel/parallel.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/support/user_error.h"
#include "tests/unit/accel/tree_check.h"
#include "tests/unit/accel/walk_check.h"

namespace marti::tests {
namespace {

using accel::BuildLimit;
using accel::Octree;
using accel::OctreeBuild;
using accel::OctreeOptions;
using accel::TriangleSet;

// The level-by-level build against the definition, for any options and any number of threads, cut or not.
RC_GTEST_PROP(OctreeBuilding, IsThatOfTheDefinitionAtAnyNumberOfThreads, ()) {
  const auto triangles = set_of(tests::hostile_soup(
      *rc::gen::element(0.0, 1e3), *rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<bool>()));
  OctreeOptions options;
  options.max_objects = *rc::gen::inRange(1U, 40U);
  options.max_level = *rc::gen::inRange(1U, 9U);
  options.max_entries = *rc::gen::element<std::uint64_t>(1, 400, 1000, 3000, std::uint64_t{1} << 25);
  options.threads = *rc::gen::inRange(1U, 5U);
  const Octree octree = Octree::build(triangles, options);
  const accel::Topology expected = plain_build(*triangles, options);
  RC_ASSERT(same_nodes(octree.topology(), expected));
  RC_ASSERT((octree.topology().work == expected.work));
  if (!octree.cut()) {
    options.max_entries = std::uint64_t{1} << 30;
    RC_ASSERT(same_nodes(octree.topology(), plain_build(*triangles, options)));
  }
}

// Nodes large enough to be sorted by several threads, levels large enough to be handed out in pieces.
TEST(OctreeBuilding, DoesNotDependOnThreads) {
  const auto triangles = std::make_shared<const TriangleSet>(scenes::make_procedural("gears:3"));
  for (const std::uint64_t entries : {std::uint64_t{100000}, std::uint64_t{1} << 25}) {
    OctreeOptions options;
    options.max_entries = entries;
    options.threads = 1;
    const Octree one = Octree::build(triangles, options);
    EXPECT_EQ(one.cut(), entries == 100000);
    for (const unsigned threads : {2U, 7U, 0U}) {
      options.threads = threads;
      const Octree many = Octree::build(triangles, options);
      EXPECT_TRUE(same_nodes(one.topology(), many.topology()));
      EXPECT_TRUE((one.topology().work == many.topology().work));
      EXPECT_TRUE((one.levels() == many.levels()));
      EXPECT_EQ(one.cut(), many.cut());
      EXPECT_EQ(one.bounds().lo, many.bounds().lo);
      EXPECT_EQ(one.bounds().hi, many.bounds().hi);
    }
  }
}

// A tree built to a level is the top of the whole tree, which splits exactly the nodes left unsplit.
TEST(OctreeBuilding, StopsAtALevel) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 3));
  const OctreeOptions options{4, 8};
  const accel::RootFrame frame = accel::make_frame(*triangles);
  const OctreeBuild whole = accel::build_octree(*triangles, options, frame);
  ASSERT_EQ(whole.levels.size(), 8U);
  EXPECT_TRUE(whole.unsplit.empty());
  std::size_t nodes = 0;
  for (std::uint32_t level = 1; level <= 8; ++level) {
    const OctreeBuild part = accel::build_octree(*triangles, options, frame, {level, 0.0});
    ASSERT_EQ(part.levels.size(), level);
    nodes += whole.levels[level - 1].nodes();
    ASSERT_EQ(part.topology.nodes.size(), nodes);
    std::size_t unsplit = 0;
    for (std::uint32_t n = 0; n < nodes; ++n) {
      ASSERT_EQ(part.topology.work[n].listed, whole.topology.work[n].listed);
      const bool left = unsplit < part.unsplit.size() && part.unsplit[unsplit] == n;
      unsplit += left ? 1U : 0U;
      // Some of those left turn out to be leaves, because splitting them separates nothing.
      ASSERT_TRUE(left ? part.topology.nodes[n].leaf
                       : part.topology.nodes[n].leaf == whole.topology.nodes[n].leaf);
      ASSERT_EQ(left, part.topology.nodes[n].leaf && part.topology.nodes[n].count > options.max_objects &&
                          part.topology.nodes[n].level == level && level < 8);
    }
    ASSERT_EQ(unsplit, part.unsplit.size());
  }
}

// The rule: the first level with more than k times as many leaves as nodes to be split, found on the whole.
TEST(OctreeBuilding, StopsByTheRatioOfLeaves) {
  const auto triangles = std::make_shared<const TriangleSet>(scenes::make_procedural("teapot:6"));
  const OctreeOptions options;
  const accel::RootFrame frame = accel::make_frame(*triangles);
  const OctreeBuild whole = accel::build_octree(*triangles, options, frame);
  std::size_t earlier = 0;
  for (const double k : {1.0, 3.0, 10.0}) {
    const OctreeBuild part = accel::build_octree(*triangles, options, frame, {0, k});
    const std::size_t stop = part.levels.size();
    EXPECT_GE(stop, earlier);
    earlier = stop;
    for (std::size_t level = 0; level + 1 < stop; ++level) {
      EXPECT_LE(static_cast<double>(whole.levels[level].leaves - whole.levels[level].overfull_leaves),
                k * static_cast<double>(whole.levels[level].branches + whole.levels[level].overfull_leaves));
    }
    ASSERT_FALSE(part.unsplit.empty());
    EXPECT_GT(static_cast<double>(part.levels.back().leaves - part.unsplit.size()),
              k * static_cast<double>(part.unsplit.size()));
  }
  EXPECT_GT(earlier, 4U);
}

TEST(OctreeBuilding, EnclosesTheBoxGiven) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 3));
  OctreeOptions options{4, 8};
  options.enclose.include({-3.0, -1.5, 0.0});
  options.enclose.include({0.5, 2.0, 4.0});
  const Octree octree = Octree::build(triangles, options);
  const scenes::Bounds& own = triangles->bounds();
  for (int a = 0; a < 3; ++a) {
    EXPECT_LE(octree.bounds().lo[a], std::min(own.lo[a], options.enclose.lo[a]));
    EXPECT_GE(octree.bounds().hi[a], std::max(own.hi[a], options.enclose.hi[a]));
    EXPECT_NEAR(octree.bounds().lo[a], std::min(own.lo[a], options.enclose.lo[a]), 1e-8);
  }
  EXPECT_TRUE(same_nodes(octree.topology(), plain_build(*triangles, options)));

  const std::vector<double> bad{std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity(), 1e300, -7.0};
  for (const double hi : bad) {
    options.enclose.hi.y = hi;
    EXPECT_NE(test::user_error_of([&] { (void)Octree::build(triangles, options); }).find("along y"),
              std::string::npos);
  }
}

// Sorting a node with Counted gives the same lists, and counts at least what each overlap test costs.
TEST(OctreeBuilding, CountingASplitChangesNothing) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 6));
  const accel::RootFrame frame = accel::make_frame(*triangles);
  std::vector<std::uint32_t> all(triangles->size());
  for (std::uint32_t id = 0; id < all.size(); ++id) {
    all[id] = id;
  }
  accel::SortedChildren plain;
  accel::SortedChildren counted;
  const accel::OctreeCell cell = accel::OctreeCell{}.child(3);
  accel::sort_into_children(*triangles, frame, cell, all, plain);
  const accel::OperationCounts before = accel::operation_counts();
  accel::sort_into_children<accel::Counted>(*triangles, frame, cell, all, counted);
  const accel::OperationCounts operations = accel::operation_counts() - before;
  EXPECT_EQ(plain.lists, counted.lists);
  EXPECT_EQ(plain.overlaps, counted.overlaps);
  // Three subtractions at least for each test, four minima and maxima for each triangle and axis.
  EXPECT_GE(operations.add, 3U * plain.overlaps);
  EXPECT_GE(operations.compare, 12U * all.size());
  EXPECT_GT(operations.integer, 0U);
}

TEST(ParallelPieces, CoverEverythingOnce) {
  for (const unsigned threads : {0U, 1U, 3U}) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{10}, std::size_t{1001}}) {
      std::vector<std::atomic<int>> met(count);
      accel::parallel_pieces(count, 10, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          ++met[k];
        }
      });
      for (const std::atomic<int>& m : met) {
        ASSERT_EQ(m, 1);
      }
    }
  }
}

}  // namespace
}  // namespace marti::tests
