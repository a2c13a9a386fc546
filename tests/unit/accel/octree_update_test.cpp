#include "accel/octree_update.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "accel/lazy_octree.h"
#include "accel/moved_primitives.h"
#include "accel/octree.h"
#include "scenes/procedural.h"
#include "tests/contract/hostile.h"
#include "tests/support/user_error.h"
#include "tests/unit/accel/tree_check.h"
#include "tests/unit/accel/walk_check.h"

namespace marti::tests {
namespace {

using accel::NodeUpdate;
using accel::Octree;
using accel::OctreeOptions;
using accel::OctreeUpdate;
using accel::TriangleCorners;
using accel::TriangleSet;

OctreeOptions enclosing(double reach) {
  OctreeOptions options;
  options.enclose.include(glm::dvec3(-reach));
  options.enclose.include(glm::dvec3(reach));
  return options;
}

/// Moves a share of the triangles: a little, across the box, onto a point, or into one that crosses many
/// cells.
std::vector<TriangleCorners> some_moved(std::vector<TriangleCorners> soup, std::uint64_t seed, double share) {
  Random random(seed);
  for (TriangleCorners& triangle : soup) {
    if (random.unit() >= share) {
      continue;
    }
    const glm::dvec3 lo(-1.9);
    const glm::dvec3 hi(1.9);
    switch (random.below(4)) {
      case 0: {
        const glm::dvec3 by = random.in_box(glm::dvec3(-0.05), glm::dvec3(0.05));
        for (std::size_t c = 0; c < 9; ++c) {
          triangle[c] += by[static_cast<int>(c % 3)];
        }
        break;
      }
      case 1:
        triangle = soup[random.below(static_cast<std::uint32_t>(soup.size()))];
        break;
      case 2: {
        const glm::dvec3 p = random.in_box(lo, hi);
        triangle = tests::corners(p, p, p);
        break;
      }
      default:
        triangle = tests::corners(random.in_box(lo, hi), random.in_box(lo, hi), random.in_box(lo, hi));
    }
  }
  return soup;
}

std::vector<scenes::Quadric> some_quadrics(std::uint64_t seed) {
  Random random(seed);
  std::vector<scenes::Quadric> quadrics;
  for (int k = 0; k < 30; ++k) {
    scenes::Quadric& quadric = quadrics.emplace_back();
    quadric.kind = std::array{scenes::QuadricKind::sphere, scenes::QuadricKind::cylinder,
                              scenes::QuadricKind::cone}[random.below(3)];
    quadric.base = random.in_box(glm::dvec3(-1.2), glm::dvec3(1.2));
    quadric.tip = quadric.base + 0.3 * random.direction();
    quadric.radius = random.between(0.01, 0.3);
    quadric.tip_radius = random.between(0.0, 0.2);
  }
  return quadrics;
}

/// What every update must fulfil, besides giving the right tree.
void check_report(const Octree& before, const Octree& fresh, const OctreeUpdate& update) {
  const accel::Topology& topology = fresh.topology();
  RC_ASSERT(update.nodes.size() == topology.nodes.size());
  RC_ASSERT(update.work.size() == topology.nodes.size());
  RC_ASSERT(update.was.size() == topology.nodes.size());
  RC_ASSERT(update.was[0] == 0U);
  for (std::uint32_t n = 0; n < topology.nodes.size(); ++n) {
    const accel::TopologyNode& node = topology.nodes[n];
    const accel::SplitWork& done = update.work[n];
    const accel::SplitWork& fresh_work = topology.work[n];
    // The same cells: the children of a kept node keep its children, in their order.
    const std::uint32_t was = update.was[n];
    RC_ASSERT((update.nodes[n] == NodeUpdate::made) == (was == accel::no_old_node && node.leaf));
    const bool goes_on = !node.leaf && update.nodes[n] != NodeUpdate::split;
    for (std::uint32_t child = 0; !node.leaf && child < 8; ++child) {
      RC_ASSERT(update.was[node.first + child] ==
                (goes_on ? before.topology().nodes[was].first + child : accel::no_old_node));
    }
    switch (update.nodes[n]) {
      case NodeUpdate::kept:
        // A full leaf of a tree that was cut is tried anew, and may turn out to be inseparable.
        RC_ASSERT(((done.listed == 0U && done.overlaps == 0U) || (node.leaf && before.cut())));
        // Where max_entries cuts a tree, the nodes left undivided depend on all nodes before them.
        for (std::uint32_t child = 0; !node.leaf && child < 8; ++child) {
          RC_ASSERT(update.nodes[node.first + child] == NodeUpdate::kept || before.cut() || update.build.cut);
        }
        break;
      case NodeUpdate::resorted:
        RC_ASSERT(!node.leaf);
        RC_ASSERT(done.listed >= 1U);
        RC_ASSERT(done.listed <= 2 * update.moved);
        break;
      case NodeUpdate::split:
        RC_ASSERT(!node.leaf);
        RC_ASSERT(done.listed == fresh_work.listed);
        RC_ASSERT(done.overlaps == fresh_work.overlaps);
        break;
      case NodeUpdate::listed:
      case NodeUpdate::collapsed:
      case NodeUpdate::made:
        RC_ASSERT(node.leaf);
        break;
    }
  }
  if (update.moved == 0 && !before.cut()) {
    RC_ASSERT(std::all_of(update.nodes.begin(), update.nodes.end(),
                          [](NodeUpdate u) { return u == NodeUpdate::kept; }));
  }
}

/// A frame: the share of primitives that move before it, and the seed of their moves.
struct Moves {
  double share = 0.0;
  std::uint64_t seed = 0;
};

/// Several frames, each updated from the one before and compared with a fresh build.
void check_frames(const OctreeOptions& options, std::uint64_t seed, bool with_quadrics,
                  const std::array<Moves, 3>& frames) {
  std::vector<TriangleCorners> now = tests::hostile_soup(0.0, seed);
  // Spheres, cylinders and cones among them.
  std::vector<scenes::Quadric> quadrics;
  if (with_quadrics) {
    quadrics = some_quadrics(1);
  }
  Octree tree = Octree::build(std::make_shared<const TriangleSet>(now, quadrics), options);
  for (const Moves& frame : frames) {
    now = some_moved(now, frame.seed, frame.share);
    std::uint32_t others = 0;
    for (scenes::Quadric& quadric : quadrics) {
      if (frame.share > 0.0 && (frame.share >= 0.3 || others == 0)) {
        quadric.radius = quadric.radius > 0.2 ? 0.1 : quadric.radius + 0.01;
        ++others;
      }
    }
    const auto after = std::make_shared<const TriangleSet>(now, quadrics);
    OctreeUpdate update = accel::update_octree(tree, *after);
    const Octree fresh = Octree::build(after, options);
    RC_ASSERT(same_nodes(update.build.topology, fresh.topology()));
    RC_ASSERT((update.build.topology.work == fresh.topology().work));
    RC_ASSERT((update.build.levels == fresh.levels()));
    RC_ASSERT(update.build.unsplit.empty());
    RC_ASSERT(update.moved >= others);
    RC_ASSERT(fresh.cut() == update.build.cut);
    check_report(tree, fresh, update);
    tree = Octree(after, options, tree.frame(), std::move(update.build));
  }
}

RC_GTEST_PROP(OctreeUpdating, GivesTheTreeOfAFreshBuild, ()) {
  OctreeOptions options = enclosing(2.0);
  options.max_objects = *rc::gen::inRange(1U, 20U);
  options.max_level = *rc::gen::inRange(1U, 8U);
  options.max_entries =
      *rc::gen::element<std::uint64_t>(400, 2000, std::uint64_t{1} << 25, std::uint64_t{1} << 25);
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const bool with_quadrics = *rc::gen::arbitrary<bool>();
  std::array<Moves, 3> frames;
  for (Moves& frame : frames) {
    frame = {*rc::gen::element(0.0, 0.003, 0.02, 0.3, 1.0), *rc::gen::arbitrary<std::uint64_t>()};
  }
  check_frames(options, seed, with_quadrics, frames);
}

// A cone that is listed for a cell without need, and for none of the cell's children, stands in no leaf
// below; but it stands in the leaf that the cell becomes.
TEST(OctreeUpdating, ListsWhatNoLeafBelowListed) {
  OctreeOptions options = enclosing(2.0);
  options.max_objects = 12;
  options.max_level = 5;
  EXPECT_NO_THROW(
      check_frames(options, 2081819264491, true, {{{0.3, 675220610}, {0.0, 0}, {0.02, 11704956984}}}));
}

// One gear of eight moves: nodes far from it are kept, and few primitives are sorted.
TEST(OctreeUpdating, KeepsWhatIsFarFromTheMovedTriangles) {
  const scenes::Scene scene = scenes::make_procedural("gears:2");
  const auto before = std::make_shared<const TriangleSet>(scene);
  OctreeOptions options;
  options.enclose.include(before->bounds().lo - 0.1);
  options.enclose.include(before->bounds().hi + 0.1);
  std::vector<TriangleCorners> corners;
  for (std::uint32_t id = 0; id < before->size(); ++id) {
    corners.push_back((*before)[id]);
    if (id < before->size() / 8) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        corners.back()[3 * corner] += 0.01;
      }
    }
  }
  const Octree tree = Octree::build(before, options);
  const auto after = set_of(corners);
  const OctreeUpdate update = accel::update_octree(tree, *after);
  EXPECT_TRUE(same_nodes(update.build.topology, Octree::build(after, options).topology()));
  std::uint64_t kept = 0;
  std::uint64_t done = 0;
  std::uint64_t fresh = 0;
  for (std::size_t n = 0; n < update.nodes.size(); ++n) {
    kept += update.altered(static_cast<std::uint32_t>(n)) ? 0U : 1U;
    done += update.work[n].overlaps;
    fresh += update.build.topology.work[n].overlaps;
  }
  EXPECT_GT(kept, update.nodes.size() / 2);
  EXPECT_LT(done, fresh / 2);
  EXPECT_EQ(update.moved, before->size() / 8);
}

TEST(OctreeUpdating, AltersExactlyWhatListsMovedTriangles) {
  const OctreeOptions options = enclosing(2.0);
  const std::vector<TriangleCorners> soup = tests::hostile_soup(0.0, 9);
  const std::vector<TriangleCorners> moved = some_moved(soup, 4, 0.02);
  const Octree tree = Octree::build(set_of(soup), options);
  const auto after = set_of(moved);
  const std::vector<std::uint32_t> ids = accel::moved_primitives(tree.triangles(), *after);
  ASSERT_FALSE(ids.empty());
  const OctreeUpdate update = accel::update_octree(tree, *after);
  const accel::Topology& topology = update.build.topology;
  const std::set<std::uint32_t> set(ids.begin(), ids.end());
  for (std::size_t n = 0; n < topology.nodes.size(); ++n) {
    const accel::TopologyNode& node = topology.nodes[n];
    if (node.leaf && update.nodes[n] == NodeUpdate::kept) {
      for (std::uint32_t k = 0; k < node.count; ++k) {
        ASSERT_FALSE(set.contains(topology.entries[node.first + k]));
      }
    }
  }
}

// A lazy tree goes on from an update.
TEST(OctreeUpdating, ALazyTreeGoesOnFromIt) {
  const OctreeOptions options = enclosing(2.0);
  const std::vector<TriangleCorners> soup = tests::hostile_soup(0.0, 9);
  const Octree tree = Octree::build(set_of(soup), options);
  const auto after = set_of(some_moved(soup, 4, 0.1));
  const OctreeUpdate update = accel::update_octree(tree, *after);
  const accel::LazyOctree lazy(after, options, tree.frame(), update.build);
  EXPECT_TRUE(same_nodes(lazy.snapshot().topology, update.build.topology));
  EXPECT_EQ(lazy.state().all.pending, 0U);
}

TEST(OctreeUpdating, RefusesAnotherRootOrOtherTriangles) {
  std::vector<TriangleCorners> soup = tests::hostile_soup(0.0, 2);
  const Octree tight = Octree::build(set_of(soup), {});
  std::vector<TriangleCorners> fewer(soup.begin(), soup.end() - 1);
  EXPECT_NE(test::user_error_of([&] {
              (void)accel::update_octree(tight, TriangleSet(fewer));
            }).find("only their places may change"),
            std::string::npos);
  soup[0][0] = 7.0;
  EXPECT_NE(
      test::user_error_of([&] { (void)accel::update_octree(tight, TriangleSet(soup)); }).find("encloses"),
      std::string::npos);
  const Octree nothing = Octree::build(set_of({}), {});
  EXPECT_EQ(accel::update_octree(nothing, TriangleSet{}).nodes.size(), 1U);
}

}  // namespace
}  // namespace marti::tests
