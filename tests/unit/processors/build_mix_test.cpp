// The cost of splitting a node, against a new measurement; and the lists of branches of real trees.
#include "processors/cost/build_mix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "accel/octree.h"
#include "processors/node/branch_lists.h"
#include "program_scenes.h"
#include "scenes/procedural.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace node;

namespace {

// Within 3 %, or a fiftieth of an operation where there is next to none.
void expect_close(const char* part, const OperationMix& measured, const OperationMix& table) {
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
  const MeasuredBuild measured = measure_build_mixes(octree);
  expect_close("listed", measured.mixes.listed, build_mixes().listed);
  expect_close("overlap", measured.mixes.overlap, build_mixes().overlap);
  expect_close("child", measured.mixes.child, build_mixes().child);
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
