// What a walk costs per unit length: the closed forms of an isotropic ray through a cube.
#include <gtest/gtest.h>

#include <vector>

#include "studies/operations/unit_length.h"

namespace marti::studies {

using namespace operations;

namespace {

constexpr std::uint32_t rays = 3000;

double per_unit(std::uint64_t count, const UnitLengthRow& row) {
  return static_cast<double>(count) / row.length;
}

// Cauchy: the mean chord of the unit cube is 2/3, and an isotropic ray crosses 1.5 planes of unit distance
// per unit length. With w cells along an axis that makes 1.5 (w - 1) / w + 1 / (2/3 w) = 1.5 cells, at every
// w; and 1.5 / 2^j nodes of the level j above the finest.
TEST(UnitLength, CellsAndNodesAreThoseOfIsotropicRays) {
  for (const UnitLengthRow& row : measure_unit_lengths(6, rays)) {
    EXPECT_EQ(row.width, 1U << (row.depth - 1));
    EXPECT_NEAR(row.length / row.width / rays, 2.0 / 3.0, 0.02) << row.depth;
    EXPECT_NEAR(per_unit(row.cells, row), 1.5, 0.03) << row.depth;
    const double nodes = 3.0 - 1.5 / row.width;
    EXPECT_NEAR(per_unit(row.full_branches + row.full_leaves, row), nodes, 0.02 * nodes) << row.depth;
    EXPECT_NEAR(per_unit(row.full_leaves, row), 1.5, 0.03) << row.depth;
    // Both walks meet the same cells.
    EXPECT_NEAR(static_cast<double>(row.full_leaves), static_cast<double>(row.cells),
                1e-3 * static_cast<double>(row.cells));
  }
}

// A grid's step: the paper's two additions and two comparisons, and the further operations of grid.h.
TEST(UnitLength, AGridStepIsNearlyThePapers) {
  const UnitLengthRow row = measure_unit_lengths(6, rays).back();
  const auto steps = static_cast<double>(row.cells - rays);  // the last cell of a ray has none
  EXPECT_NEAR(static_cast<double>(row.grid.add) / steps, 1.0, 1e-9) << "one for the plane";
  EXPECT_NEAR(static_cast<double>(row.grid.multiply) / steps, 1.0, 1e-9) << "and one to scale it";
  EXPECT_EQ(row.grid.divide, 0U);
  const auto cells = static_cast<double>(row.cells);
  EXPECT_NEAR(static_cast<double>(row.grid.compare) / cells, 3.0, 0.05) << "two find the axis, one the end";
  EXPECT_NEAR(static_cast<double>(row.grid.integer) / cells, 4.0, 0.1);
}

// HERO's branch: three averages, which are three additions and three halvings.
TEST(UnitLength, AnOctreesBranchTakesThreeAverages) {
  const UnitLengthRow row = measure_unit_lengths(6, rays).back();
  const auto branches = static_cast<double>(row.full_branches);
  EXPECT_EQ(row.full.multiply, 3 * row.full_branches);
  EXPECT_EQ(row.full.divide, 0U);
  EXPECT_GE(row.full.add, 3 * row.full_branches);
  // One addition more for each leaf that a nearer hit could have made needless.
  EXPECT_LE(static_cast<double>(row.full.add), 3.0 * branches + static_cast<double>(row.full_leaves));
}

// A ray through a tree that is deep along a surface only meets a constant number of further leaves with each
// further level, so fewer and fewer per unit length.
TEST(UnitLength, ATreeAlongASurfaceTakesLeavesInProportionToItsDepth) {
  const std::vector<UnitLengthRow> rows = measure_unit_lengths(7, 1500);
  const auto leaves = [&](std::uint32_t depth) {
    const UnitLengthRow& row = rows.at(depth - 2);
    EXPECT_EQ(row.depth, depth);
    return static_cast<double>(row.surface_leaves) / 1500;
  };
  const double more = leaves(6) - leaves(5);
  EXPECT_GT(more, 2.0);
  EXPECT_NEAR(leaves(7) - leaves(6), more, 0.1 * more);
  EXPECT_LT(per_unit(rows[5].surface_leaves, rows[5]), 0.7 * per_unit(rows[4].surface_leaves, rows[4]));
}

}  // namespace
}  // namespace marti::studies
