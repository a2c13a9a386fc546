// The cost of splitting a node, against a new measurement; and the lists of branches of real trees.
#include "processors/cost/build_mix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "accel/bvh_bins.h"
#include "accel/bvh_build.h"
#include "accel/octree.h"
#include "accel/octree_sort.h"
#include "processors/cost/tree_work.h"
#include "processors/node/branch_lists.h"
#include "program_scenes.h"
#include "scenes/procedural.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace node;

namespace {

// The result of a measurement: the means, and how many samples each mean is of.
struct MeasuredBuild {
  BuildMixes mixes;
  std::uint64_t listed = 0;
  std::uint64_t overlaps = 0;
  std::uint64_t children = 0;
};

// Counts minus the share that the mean `each` predicts for them; 0 where a count is below its share.
accel::OperationCounts beyond(const accel::OperationCounts& counts, const OperationMix& each,
                              std::uint64_t times) {
  const auto rest = [times](std::uint64_t count, std::int64_t mean) {
    const std::uint64_t share = (static_cast<std::uint64_t>(mean) * times + 500) / 1000;
    return count > share ? count - share : 0;
  };
  return {rest(counts.add, each.add),         rest(counts.multiply, each.multiply),
          rest(counts.divide, each.divide),   rest(counts.square_root, each.square_root),
          rest(counts.compare, each.compare), rest(counts.integer, each.integer)};
}

// Splits every branch of the tree once more, with the counting scalar. The mean `listed` is over the
// primitives that need no overlap test; what the others take beyond that is divided among their overlap
// tests, so that means times numbers give the operations counted.
class Measurement {
 public:
  explicit Measurement(const accel::Octree& octree)
      : octree_(octree), frame_(accel::make_frame(octree.triangles())) {}

  MeasuredBuild run() {
    std::vector<std::uint32_t> all(octree_.triangles().size());
    std::iota(all.begin(), all.end(), 0U);
    split(0, {}, all);
    measured_.mixes.listed = mean_mix(untested_counts_, untested_);
    measured_.mixes.overlap =
        mean_mix(beyond(tested_counts_, measured_.mixes.listed, tested_), measured_.overlaps);
    measured_.mixes.child = mean_mix(child_counts_, measured_.children);
    measured_.listed = untested_ + tested_;
    return measured_;
  }

 private:
  void split(std::uint32_t number, const accel::OctreeCell& cell, const std::vector<std::uint32_t>& list) {
    const accel::TopologyNode& node = octree_.topology().nodes[number];
    if (node.leaf) {
      return;
    }
    accel::OperationCounts before = accel::operation_counts();
    const accel::ChildSorter<accel::Counted> sorter(frame_, cell);
    child_counts_ += accel::operation_counts() - before;
    measured_.children += node.count;
    std::array<std::vector<std::uint32_t>, 8> lists;
    for (const std::uint32_t id : list) {
      std::uint32_t tests = 0;
      before = accel::operation_counts();
      const std::uint32_t met = sorter.children(octree_.triangles(), id, tests);
      (tests == 0 ? untested_counts_ : tested_counts_) += accel::operation_counts() - before;
      ++(tests == 0 ? untested_ : tested_);
      measured_.overlaps += tests;
      for (std::uint32_t child = 0; child < 8; ++child) {
        if ((met >> child & 1U) != 0) {
          lists[child].push_back(id);
        }
      }
    }
    for (std::uint32_t child = 0; child < 8; ++child) {
      split(node.first + child, cell.child(child), lists[child]);
    }
  }

  const accel::Octree& octree_;
  accel::RootFrame frame_;
  MeasuredBuild measured_;
  accel::OperationCounts untested_counts_;
  accel::OperationCounts tested_counts_;
  accel::OperationCounts child_counts_;
  std::uint64_t untested_ = 0;
  std::uint64_t tested_ = 0;
};

// Within 3 %, or a fiftieth of an operation where there is next to none.
void expect_close_mix(const char* part, const OperationMix& measured, const OperationMix& table) {
  for (const auto member : {&OperationMix::add, &OperationMix::multiply, &OperationMix::divide,
                            &OperationMix::square_root, &OperationMix::compare, &OperationMix::integer}) {
    const auto expected = static_cast<double>(table.*member);
    EXPECT_NEAR(static_cast<double>(measured.*member), expected, std::max(20.0, 0.03 * expected)) << part;
  }
}

TEST(BuildMixes, TheTableIsWhatTheBuilderDoes) {
  const scenes::Scene scene = scenes::make_procedural("teapot:12");
  const auto octree = accel::Octree::build(std::make_shared<const accel::TriangleSet>(scene),
                                           {.max_objects = 9, .max_level = 12});
  const MeasuredBuild measured = Measurement(octree).run();
  expect_close_mix("listed", measured.mixes.listed, build_mixes().listed);
  expect_close_mix("overlap", measured.mixes.overlap, build_mixes().overlap);
  expect_close_mix("child", measured.mixes.child, build_mixes().child);
  // The counting split equals the builder's.
  const accel::Topology& topology = octree.topology();
  std::uint64_t listed = 0;
  std::uint64_t overlaps = 0;
  for (std::size_t node = 0; node < topology.nodes.size(); ++node) {
    listed += topology.nodes[node].leaf ? 0 : topology.work[node].listed;
    overlaps += topology.work[node].overlaps;
  }
  EXPECT_EQ(measured.listed, listed);
  EXPECT_EQ(measured.overlaps, overlaps);
  EXPECT_EQ(measured.children, topology.nodes.size() - 1);
}

/// Means over the nodes of the binary tree that accel::BvhWork counts.
BvhMixes measured_bvh_mixes(const accel::TriangleSet& set, const accel::BvhOptions& options) {
  const accel::BvhSpace space(accel::make_frame(set));
  const accel::BvhBinaryTree tree = accel::build_binary_bvh(set, {0, set.size()}, space, options);
  using Box = accel::BvhBoxOf<accel::CountedFloat>;
  accel::OperationCounts& counts = accel::operation_counts();
  accel::OperationCounts bounded;
  accel::OperationCounts sorted;
  accel::OperationCounts planes;
  accel::OperationCounts merged;
  std::vector<Box> boxes;
  Box all;
  for (std::uint32_t id = 0; id < set.size(); ++id) {
    accel::OperationCounts before = counts;
    const accel::BvhBox box = accel::bvh_box_of<accel::Counted>(space, set, id);
    bounded += counts - before;
    boxes.emplace_back();
    std::copy_n(box.lo.begin(), 3, boxes.back().lo.begin());
    std::copy_n(box.hi.begin(), 3, boxes.back().hi.begin());
    before = counts;
    all.include(boxes.back());
    merged += counts - before;
  }
  accel::BvhSplits splits;
  accel::BvhBins<accel::CountedFloat> bins;
  for (const accel::BvhBinaryNode& node : tree.nodes) {
    if (node.count < 2 || node.below_leaf) {
      continue;
    }
    const std::span<const std::uint32_t> listed = std::span(tree.entries).subspan(node.begin, node.count);
    accel::OperationCounts before = counts;
    Box centroids;
    for (const std::uint32_t id : listed) {
      centroids.include(boxes[id].centroid());
    }
    sorted += counts - before;
    before = counts;
    const accel::BvhBinning<accel::CountedFloat> binning(centroids, options.bins, node.count);
    planes += counts - before;
    bins.clear(binning.bins);
    before = counts;
    for (const std::uint32_t id : listed) {
      bins.add(boxes[id], binning);
    }
    sorted += counts - before;
    before = counts;
    (void)bins.best_plane(binning);
    planes += counts - before;
    splits += {1, node.count, binning.planes(), 0};
  }
  accel::BvhSplits counted;
  for (const accel::BvhSplits& size : tree.work.by_size) {
    counted += size;
  }
  EXPECT_EQ(splits.references, counted.references);
  EXPECT_EQ(splits.planes, counted.planes);
  return {.bounded = mean_mix(bounded, set.size()),
          .placed = {},
          .sorted = mean_mix(sorted, splits.references),
          .plane = mean_mix(planes, splits.planes),
          .merged = mean_mix(merged, set.size())};
}

TEST(BvhMixes, TheTableIsWhatTheBuilderDoes) {
  const BvhMixes measured =
      measured_bvh_mixes(accel::TriangleSet(scenes::make_procedural("teapot:12")), {.threads = 1});
  expect_close_mix("bounded", measured.bounded, bvh_mixes().bounded);
  expect_close_mix("sorted", measured.sorted, bvh_mixes().sorted);
  expect_close_mix("plane", measured.plane, bvh_mixes().plane);
  expect_close_mix("merged", measured.merged, bvh_mixes().merged);
}

TEST(BuildMixes, UnitCostsAddUpByHand) {
  const OperationCycles unit;
  const BuildCycles cycles = build_cycles(unit, {.node = 2, .entry = 1, .primitive = 12});
  const auto all = [](const OperationMix& mix) {
    return (mix.add + mix.multiply + mix.divide + mix.square_root + mix.compare + mix.integer + 500) / 1000;
  };
  EXPECT_EQ(cycles.lock, 3);
  EXPECT_EQ(cycles.listed, all(build_mixes().listed) + 2 + 13);
  EXPECT_EQ(cycles.overlap, all(build_mixes().overlap));
  EXPECT_EQ(cycles.child, all(build_mixes().child) + 3);
  EXPECT_EQ(cycles.entry, 2);
  EXPECT_EQ(cycles.publish, 3);
}

// The list that the simulated machine puts together from the leaves is the one that the builder split.
TEST(DynamicFrames, ABranchListedWhatItsLeavesDo) {
  for (const char* kind : {"octree", "bsp"}) {
    const test::Built built(scenes::make_procedural("gears:2"), kind);
    const accel::Topology& topology = built.structure->topology();
    BranchLists lists(topology);
    for (std::uint32_t node = 0; node < topology.nodes.size(); ++node) {
      ASSERT_EQ(lists.of(node).size(), topology.work[node].listed) << kind << " node " << node;
    }
  }
}

}  // namespace
}  // namespace marti::processors
