// The work that building a bounding volume hierarchy is said to take, against a naive second count.
#include "accel/bvh_work.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>
#include <numeric>
#include <set>
#include <vector>

#include "accel/bvh.h"
#include "accel/bvh_build.h"
#include "accel/two_level.h"
#include "scenes/procedural.h"
#include "tests/contract/hostile.h"
#include "tests/contract/hostile_quadrics.h"

namespace marti::tests {
namespace {

using accel::BvhBinaryNode;
using accel::BvhBinaryTree;
using accel::BvhBox;
using accel::BvhOptions;
using accel::BvhSpace;
using accel::BvhSplits;
using accel::BvhWork;
using accel::TriangleSet;

BvhSplits sum_of(const BvhWork& work) {
  return std::accumulate(work.by_size.begin(), work.by_size.end(), BvhSplits{},
                         [](BvhSplits sum, const BvhSplits& of) { return sum += of; });
}

BvhBinaryTree build(const TriangleSet& set, const BvhOptions& options) {
  return accel::build_binary_bvh(set, {0, set.size()}, BvhSpace(accel::make_frame(set)), options);
}

// The planes that lie between bins of the primitives' centres.
std::uint32_t planes_between(const std::vector<std::uint32_t>& ids, const TriangleSet& set,
                             std::uint32_t bins) {
  const BvhSpace space(accel::make_frame(set));
  std::uint32_t planes = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<float> centres;
    for (const std::uint32_t id : ids) {
      centres.push_back(accel::bvh_box_of(space, set, id).centroid()[axis]);
    }
    const auto [low, high] = std::ranges::minmax(centres);
    planes += high - low > 0x1p-100F
                  ? std::min<std::uint32_t>(bins, 2 * static_cast<std::uint32_t>(ids.size())) - 1
                  : 0;
  }
  return planes;
}

// Builds the tree's order of primitives once more, node by node, from what each node of it lists in the end.
class Recount {
 public:
  Recount(const BvhBinaryTree& tree, const TriangleSet& set, std::uint32_t bins)
      : tree_(tree), set_(set), bins_(bins), order_(set.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
  }

  BvhWork run() {
    visit(0, 1, false);
    return work_;
  }

 private:
  void visit(std::uint32_t number, std::uint32_t level, bool below) {
    const BvhBinaryNode& node = tree_.nodes[number];
    if (node.count < 2) {
      return;
    }
    const auto begin = order_.begin() + node.begin;
    const auto end = begin + node.count;
    const BvhBinaryNode& first = tree_.nodes[node.first];
    const auto listed = tree_.entries.begin() + first.begin;
    const std::set<std::uint32_t> firsts(listed, listed + first.count);
    const auto is_first = [&](std::uint32_t id) { return firsts.contains(id); };
    const auto moved =
        static_cast<std::uint64_t>(2 * std::count_if(begin, begin + first.count, std::not_fn(is_first)));
    // A list of this length is cut into halves if halves of it might be on more than 61 levels.
    std::uint32_t levels = level;
    for (std::uint32_t left = node.count; left > 1; left = (left + 1) / 2) {
      ++levels;
    }
    if (!below && levels < 61) {
      const std::uint32_t planes = planes_between(std::vector(begin, end), set_, bins_);
      work_.of_size(node.count) += {1, node.count, planes, node.leaf ? 0 : moved};
      work_.levels = std::max(work_.levels, level);
    }
    std::partition(begin, end, is_first);
    visit(node.first, level + 1, below || node.leaf);
    visit(node.first + 1, level + 1, below || node.leaf);
  }

  const BvhBinaryTree& tree_;
  const TriangleSet& set_;
  std::uint32_t bins_;
  std::vector<std::uint32_t> order_;
  BvhWork work_;
};

TEST(BvhWork, IsThatOfANaiveRecount) {
  const std::vector<TriangleSet> sets = [] {
    std::vector<TriangleSet> all;
    all.emplace_back(hostile_soup(0.0, 1), hostile_quadrics(0.0, 1));
    all.emplace_back(hostile_soup(1e6, 2));
    all.emplace_back(scenes::make_procedural("teapot:6"));
    return all;
  }();
  for (const TriangleSet& set : sets) {
    for (const BvhOptions& options : {BvhOptions{.max_objects = 1, .bins = 4, .threads = 1},
                                      BvhOptions{.max_objects = 3, .bins = 32, .threads = 1}}) {
      const BvhBinaryTree tree = build(set, options);
      EXPECT_EQ(tree.work, Recount(tree, set, options.bins).run());
      EXPECT_GT(sum_of(tree.work).moved, 0U);
      EXPECT_EQ(accel::Bvh::build(std::make_shared<const TriangleSet>(set), options).work(), tree.work);
    }
  }
}

// Triangles with the corners p, p + (1, 0, 0), p + (0, 1, 0).
TriangleSet triangles_at(const std::vector<glm::dvec3>& places) {
  std::vector<accel::TriangleCorners> corners;
  for (const glm::dvec3& p : places) {
    corners.push_back({p.x, p.y, p.z, p.x + 1.0, p.y, p.z, p.x, p.y + 1.0, p.z});
  }
  return TriangleSet(std::move(corners));
}

TEST(BvhWork, OfFewPrimitivesIsKnown) {
  const BvhOptions single{.max_objects = 1, .threads = 1};
  EXPECT_EQ(sum_of(build(triangles_at({{0, 0, 0}}), single).work), BvhSplits());
  // Two take four bins each way, and are exchanged where they are listed the other way round.
  const glm::dvec3 far{8, 9, 10};
  EXPECT_EQ(sum_of(build(triangles_at({{0, 0, 0}, far}), single).work), (BvhSplits{1, 2, 9, 0}));
  EXPECT_EQ(sum_of(build(triangles_at({far, {0, 0, 0}}), single).work), (BvhSplits{1, 2, 9, 2}));
  // No plane separates equal ones: eight are cut into halves on three levels.
  const std::vector<glm::dvec3> equal(8, glm::dvec3(1.0));
  EXPECT_EQ(sum_of(build(triangles_at(equal), single).work), (BvhSplits{7, 24, 0, 0}));
  EXPECT_EQ(build(triangles_at(equal), single).work.levels, 3U);
  // Where a leaf may list them all, only the root was looked at.
  const BvhOptions wide{.max_objects = 8, .threads = 1};
  EXPECT_EQ(sum_of(build(triangles_at(equal), wide).work), (BvhSplits{1, 8, 0, 0}));
}

TEST(BvhWork, IsTheSameOnAnyNumberOfThreads) {
  const TriangleSet set(scenes::make_procedural("teapot:33"));
  ASSERT_GT(set.size(), 1U << 16U);  // all threads split the root together
  const BvhWork one = build(set, {.threads = 1}).work;
  EXPECT_EQ(build(set, {.threads = 3}).work, one);
  EXPECT_EQ(one.by_size.size(), 18U);
  EXPECT_EQ(one.by_size.back().nodes, 1U);
  EXPECT_EQ(one.by_size.back().references, set.size());
}

// Two meshes of 40 and of 300 triangles, in five places.
scenes::Scene two_meshes() {
  scenes::Scene scene = scenes::make_procedural("teapot:4");
  scene.triangles.resize(340);
  scene.meshes = {{0, 40}, {40, 300}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    scenes::InstancePlace place;
    place.mesh = i % 2;
    place.first = place.mesh == 0 ? 0 : 40;
    place.shift = {20.0 * i, 0.0, 0.0};
    scene.instances.push_back(place);
  }
  return scene;
}

TEST(BvhWork, OfKeptInstancesIsThatOfTheTreesThatWereBuilt) {
  scenes::Scene scene = two_meshes();
  const auto before = std::make_shared<const TriangleSet>(scene);
  const accel::TwoLevelBvh tree = accel::TwoLevelBvh::build(before);
  scene.positions[scene.triangles[100].vertex[0]].z += 1e-3;
  const auto after = std::make_shared<const TriangleSet>(scene);
  using Update = accel::TwoLevelBvh::Update;
  const accel::TwoLevelBvh moved = tree.moved(after, Update::rebuild);
  const BvhSplits top = sum_of(tree.moved(before, Update::rebuild).work());
  const auto of_mesh = [&](std::uint32_t mesh) {
    const accel::PrimitiveRange& range = after->meshes()[mesh];
    return sum_of(
        accel::Bvh::build(after, range, accel::make_frame(after->bounds(range), 0x1p14), {}).work());
  };
  EXPECT_EQ(top.references, sum_of(moved.work()).references - of_mesh(1).references);
  EXPECT_GE(top.references, 5U);
  BvhSplits all = top;
  all += of_mesh(0);
  all += of_mesh(1);
  EXPECT_EQ(sum_of(accel::TwoLevelBvh::build(after).work()), all);
  EXPECT_GT(moved.work().levels, tree.moved(before, Update::rebuild).work().levels);
  // What was built before has been charged before.
  EXPECT_EQ(sum_of(moved.moved(after, Update::rebuild).work()), top);
  EXPECT_EQ(sum_of(moved.moved(before, Update::refit).work()), BvhSplits());
}

}  // namespace
}  // namespace marti::tests
