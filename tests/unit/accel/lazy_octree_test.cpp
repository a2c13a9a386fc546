#include "accel/lazy_octree.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "accel/octree.h"
#include "accel/structure.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/support/same_bits.h"
#include "tests/support/user_error.h"
#include "tests/unit/accel/tree_check.h"
#include "tests/unit/accel/walk_check.h"

namespace marti::tests {
namespace {

using accel::LazyOctree;
using accel::LazyOctreeOptions;
using accel::LazyOctreeState;
using accel::NullVisitor;
using accel::Octree;
using accel::OctreeBuild;
using accel::Ray;
using accel::TriangleSet;

accel::BuildLimit any_limit() {
  accel::BuildLimit limit;
  limit.level = *rc::gen::inRange(0U, 7U);
  limit.k = *rc::gen::element(0.0, 0.0, 1.0, 3.0, 10.0);
  return limit;
}

RC_GTEST_PROP(LazyTree, ExpandedInAnyOrderIsTheEagerTree, ()) {
  const auto triangles = set_of(tests::hostile_soup(0.0, *rc::gen::arbitrary<std::uint64_t>()));
  LazyOctreeOptions options;
  options.tree.max_objects = *rc::gen::inRange(1U, 20U);
  options.tree.max_level = *rc::gen::inRange(1U, 8U);
  options.initial = any_limit();
  const LazyOctree lazy = LazyOctree::build(triangles, options);
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  std::uint64_t subdivided = 0;
  for (std::vector<std::uint32_t> pending = lazy.pending(); !pending.empty(); pending = lazy.pending()) {
    // A few at a time, in any order, some of them twice.
    for (int k = 0; k < 10; ++k) {
      lazy.subdivide(pending[random.below(static_cast<std::uint32_t>(pending.size()))]);
    }
    const LazyOctreeState state = lazy.state();
    RC_ASSERT(state.subdivided > subdivided);
    subdivided = state.subdivided;
    RC_ASSERT(state.all.pending == lazy.pending().size());
  }
  const Octree eager = Octree::build(triangles, options.tree);
  const OctreeBuild grown = lazy.snapshot();
  RC_ASSERT(same_nodes(grown.topology, eager.topology()));
  RC_ASSERT((grown.levels == eager.levels()));
  RC_ASSERT(grown.unsplit.empty());
  RC_ASSERT(lazy.state().list_bytes == 4 * eager.topology().entries.size());
}

/// Every node of a partly grown tree is one of the eager tree, its list included.
void check_part(const OctreeBuild& part, const Octree& eager) {
  const accel::Topology& whole = eager.topology();
  std::vector<std::uint32_t> same{0};  // [node of part]: the eager tree's node of the same cell
  same.resize(part.topology.nodes.size());
  std::size_t pending = 0;
  for (std::uint32_t n = 0; n < part.topology.nodes.size(); ++n) {
    const accel::TopologyNode& mine = part.topology.nodes[n];
    const accel::TopologyNode& theirs = whole.nodes[same[n]];
    RC_ASSERT(mine.level == theirs.level);
    const bool waits = pending < part.unsplit.size() && part.unsplit[pending] == n;
    pending += waits ? 1U : 0U;
    if (!mine.leaf) {
      RC_ASSERT(!theirs.leaf);
      for (std::uint32_t child = 0; child < 8; ++child) {
        same[mine.first + child] = theirs.first + child;
      }
      continue;
    }
    RC_ASSERT(mine.count == whole.work[same[n]].listed);
    if (theirs.leaf) {
      RC_ASSERT(std::equal(part.topology.entries.begin() + mine.first,
                           part.topology.entries.begin() + mine.first + mine.count,
                           whole.entries.begin() + theirs.first));
    } else {
      RC_ASSERT(waits);
    }
  }
  RC_ASSERT(pending == part.unsplit.size());
}

RC_GTEST_PROP(LazyTree, AnyRaysOnAnyThreadsGiveTheEagerTreesHitsAndNodes, ()) {
  const auto triangles = set_of(tests::hostile_soup(0.0, *rc::gen::arbitrary<std::uint64_t>()));
  LazyOctreeOptions options;
  options.tree.max_objects = *rc::gen::inRange(1U, 10U);
  options.tree.max_level = *rc::gen::inRange(2U, 8U);
  options.initial = any_limit();
  const Octree eager = Octree::build(triangles, options.tree);
  const LazyOctree lazy = LazyOctree::build(triangles, options);
  const LazyOctreeState before = lazy.state();
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  const auto rays = *rc::gen::inRange(1, 200);
  const auto threads = *rc::gen::inRange(1U, 6U);
  std::atomic<int> different{0};
  const auto shoot = [&](std::uint64_t offset) {
    RayMaker maker(*triangles, eager.bounds(), seed + offset);
    NullVisitor visitor;
    for (int k = 0; k < rays; ++k) {
      const Ray ray = maker.make(tests::all_aims[static_cast<std::size_t>(k) % tests::all_aims.size()]);
      different += test::same_bits(lazy.closest(ray, visitor), eager.closest(ray, visitor)) ? 0 : 1;
      different += lazy.occluded(ray, visitor) == eager.occluded(ray, visitor) ? 0 : 1;
    }
  };
  {
    std::vector<std::jthread> pool;
    for (unsigned t = 0; t < threads; ++t) {
      pool.emplace_back(shoot, t % 2);  // half of them meet the same nodes at the same time
    }
  }
  RC_ASSERT(different == 0);
  const LazyOctreeState after = lazy.state();
  check_part(lazy.snapshot(), eager);
  // Exactly once each: every node made since has eight children or was a P node that stays a leaf.
  RC_ASSERT((after.all.nodes() - before.all.nodes()) % 8 == 0U);
  RC_ASSERT(after.all.branches - before.all.branches == (after.all.nodes() - before.all.nodes()) / 8);
  RC_ASSERT(after.subdivided >= after.all.branches - before.all.branches);
  lazy.expand();
  RC_ASSERT(same_nodes(lazy.snapshot().topology, eager.topology()));
}

TEST(LazyTree, CountsNodesAndBytes) {
  const auto triangles = std::make_shared<const TriangleSet>(scenes::make_procedural("teapot:4"));
  const Octree eager = Octree::build(triangles, {});
  LazyOctreeOptions options;
  options.initial.level = 4;
  const LazyOctree lazy = LazyOctree::build(triangles, options);
  const LazyOctreeState start = lazy.state();
  ASSERT_EQ(start.levels.size(), 4U);
  EXPECT_EQ(start.levels[3].branches, 0U);
  EXPECT_EQ(start.levels[3].pending + start.levels[3].leaves, eager.levels()[3].nodes());
  EXPECT_EQ(start.levels[2].branches, eager.levels()[2].branches);
  EXPECT_EQ(start.subdivided, 0U);

  const std::uint32_t node = lazy.pending().front();
  lazy.subdivide(node);
  lazy.subdivide(node);
  const LazyOctreeState next = lazy.state();
  EXPECT_EQ(next.subdivided, 1U);
  EXPECT_EQ(next.all.nodes(), start.all.nodes() + 8);
  EXPECT_EQ(next.all.branches, start.all.branches + 1);
  // The entries are those before, minus the released list, plus the lists of the eight children.
  EXPECT_GE(next.list_bytes, start.list_bytes);
  lazy.expand();
  EXPECT_EQ(lazy.state().list_bytes, 4 * eager.topology().entries.size());
  EXPECT_EQ(lazy.state().all.nodes(), eager.topology().nodes.size());
}

// It can be used through the interface of all structures.
TEST(LazyTree, IsAStructure) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 4));
  LazyOctreeOptions options;
  options.initial.level = 1;
  const std::unique_ptr<accel::Structure> lazy = accel::make_lazy_octree(triangles, options);
  const std::unique_ptr<accel::Structure> brute = accel::make_structure("none", triangles);
  EXPECT_EQ(lazy->kind(), "lazy_octree");
  RayMaker maker(*triangles, lazy->bounds(), 2);
  for (int k = 0; k < 4000; ++k) {
    const Ray ray = maker.make(tests::all_aims[static_cast<std::size_t>(k) % tests::all_aims.size()]);
    ASSERT_TRUE(test::same_bits(lazy->closest(ray), brute->closest(ray)));
    ASSERT_EQ(lazy->occluded(ray), brute->occluded(ray));
  }
  EXPECT_EQ(accel::visit_structure(*lazy, [](const auto& concrete) { return concrete.kind_name; }),
            "lazy_octree");
  EXPECT_NE(test::user_error_of([&] { (void)lazy->topology(); }).find("work log"), std::string::npos);
}

// It never differs silently from the eager tree: a ray that comes to the limit ends in an error.
TEST(LazyTree, RefusesToBeCut) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 5));
  LazyOctreeOptions options;
  options.tree = {1, 10, 3000};
  options.initial.level = 1;
  ASSERT_TRUE(Octree::build(triangles, options.tree).cut());
  const LazyOctree lazy = LazyOctree::build(triangles, options);
  std::atomic<int> refused{0};
  {
    std::vector<std::jthread> pool;
    for (int t = 0; t < 3; ++t) {
      pool.emplace_back([&] {
        refused +=
            test::user_error_of([&] { lazy.expand(); }).find("max_entries (3000)") != std::string::npos;
      });
    }
  }
  EXPECT_EQ(refused, 3);
  EXPECT_GT(lazy.state().all.pending, 0U);
  EXPECT_LT(lazy.state().list_bytes, 4U * 3000U);
  options.initial.level = 0;
  EXPECT_NE(test::user_error_of([&] { (void)LazyOctree::build(triangles, options); }).find("max_entries"),
            std::string::npos);
  options.tree.max_objects = 0;
  EXPECT_NE(test::user_error_of([&] { (void)LazyOctree::build(triangles, options); }).find("max_objects"),
            std::string::npos);
}

TEST(LazyTree, HasNothingToDoWithoutTriangles) {
  LazyOctreeOptions options;
  options.initial.level = 1;
  const LazyOctree lazy = LazyOctree::build(set_of({}), options);
  NullVisitor visitor;
  EXPECT_FALSE(lazy.closest({}, visitor).found());
  EXPECT_EQ(lazy.state().all.leaves, 1U);
  EXPECT_TRUE(lazy.pending().empty());
}

}  // namespace
}  // namespace marti::tests
