#include "accel/precision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace marti::accel {
namespace {

/// A sheet of 2 * n * n triangles, `size` on each side, moved to (offset, offset, offset).
TriangleSet sheet(double offset, double size, int n) {
  std::vector<TriangleCorners> all;
  const double step = size / n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = offset + i * step;
      const double y = offset + j * step;
      all.push_back({x, y, offset, x + step, y, offset, x, y + step, offset});
      all.push_back({x + step, y, offset, x + step, y + step, offset, x, y + step, offset});
    }
  }
  return TriangleSet(std::move(all));
}

TEST(PrecisionNeed, NothingIsSaidOfAnOrdinaryScene) {
  const PrecisionNeed need = precision_need(sheet(1.0, 4.0, 10));
  EXPECT_FALSE(need.wants_double());
  EXPECT_EQ(need.primitives, 200U);
  EXPECT_EQ(need.collapsed, 0U);
  EXPECT_EQ(need.out_of_range, 0U);
  EXPECT_DOUBLE_EQ(need.spacing, 0x1p-21);  // of floats from 4 to 8
  EXPECT_EQ(describe_need(need), "");
}

TEST(PrecisionNeed, TrianglesThatCollapseAreCounted) {
  // At 2^24 floats are 1 apart below and 2 above: steps of 0.25 all round to the same few places.
  const PrecisionNeed need = precision_need(sheet(0x1p24, 4.0, 16));
  EXPECT_TRUE(need.wants_double());
  EXPECT_GT(need.collapsed, 256U);
  EXPECT_LE(need.collapsed, 512U);
  EXPECT_DOUBLE_EQ(need.spacing, 2.0);
  EXPECT_DOUBLE_EQ(need.steps, 2.0);
  EXPECT_NE(describe_need(need).find(" of 512 primitives would collapse"), std::string::npos);
}

TEST(PrecisionNeed, FewStepsAcrossTheSceneAreEnoughToAskForDoubles) {
  // 4 / 2^-13: 32768 steps across, but no triangle of this size collapses.
  const PrecisionNeed need = precision_need(sheet(1024.0, 4.0, 8));
  EXPECT_EQ(need.collapsed, 0U);
  EXPECT_DOUBLE_EQ(need.steps, 32768.0);
  EXPECT_TRUE(need.wants_double());
  EXPECT_FALSE(precision_need(sheet(64.0, 4.0, 8)).wants_double());
}

TEST(PrecisionNeed, DegenerateInDoublesIsNotTheFloatsFault) {
  const PrecisionNeed need =
      precision_need(TriangleSet({{0, 0, 0, 1, 1, 1, 2, 2, 2}, {0, 0, 0, 1, 0, 0, 0, 1, 0}}));
  EXPECT_EQ(need.collapsed, 0U);
  EXPECT_FALSE(need.wants_double());
}

TEST(PrecisionNeed, LengthsBeyondAFloatsProducts) {
  for (const double size : {1e-30, 1e-200, 1e30, 1e60}) {
    const PrecisionNeed need = precision_need(sheet(0.0, size, 1));
    EXPECT_EQ(need.out_of_range, 2U) << size;
    EXPECT_TRUE(need.wants_double()) << size;
  }
  // Small triangles far beyond the largest float: nothing is left at all.
  const PrecisionNeed beyond = precision_need(sheet(1e39, 1e24, 1));
  EXPECT_TRUE(beyond.wants_double());
  EXPECT_TRUE(std::isinf(beyond.spacing));
}

TEST(PrecisionNeed, CurvedPrimitivesToo) {
  scenes::Quadric ball;
  ball.radius = 0.01;
  ball.base = {1e6, 0.0, 0.0};
  scenes::Quadric other = ball;
  other.base = {1e6, 3.0, 0.0};
  const PrecisionNeed need = precision_need(TriangleSet({}, {ball, other}));
  EXPECT_EQ(need.primitives, 2U);
  EXPECT_EQ(need.collapsed, 2U);
  ball.base = {1.0, 0.0, 0.0};
  EXPECT_EQ(precision_need(TriangleSet({}, {ball})).collapsed, 0U);
}

TEST(PrecisionNeed, NoPrimitivesAtAll) {
  const PrecisionNeed need = precision_need(TriangleSet());
  EXPECT_FALSE(need.wants_double());
  EXPECT_EQ(need.primitives, 0U);
}

}  // namespace
}  // namespace marti::accel
