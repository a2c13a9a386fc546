#include "accel/grid.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/support/long_tests.h"
#include "tests/unit/accel/walk_check.h"

namespace marti::tests {
namespace {

using accel::Grid;
using accel::GridOptions;
using accel::TriangleCorners;

GridOptions with(std::array<std::uint32_t, 3> resolution) {
  GridOptions options;
  options.resolution = resolution;
  return options;
}

/// The boxes of all nodes, from the resolution alone.
std::vector<scenes::Bounds> boxes_of(const Grid& grid) {
  std::vector<scenes::Bounds> boxes{grid.bounds()};
  const std::array<std::uint32_t, 3>& n = grid.resolution();
  const glm::dvec3 size = (grid.bounds().hi - grid.bounds().lo) / glm::dvec3(n[0], n[1], n[2]);
  for (std::uint32_t z = 0; z < n[2]; ++z) {
    for (std::uint32_t y = 0; y < n[1]; ++y) {
      for (std::uint32_t x = 0; x < n[0]; ++x) {
        scenes::Bounds& box = boxes.emplace_back();
        box.lo = grid.bounds().lo + size * glm::dvec3(x, y, z);
        box.hi = grid.bounds().lo + size * glm::dvec3(x + 1, y + 1, z + 1);
      }
    }
  }
  return boxes;
}

TEST(Grid, IsAHeaderAndItsCells) {
  const Grid grid = Grid::build(set_of(tests::hostile_soup(0.0, 1)), with({3, 5, 7}));
  const auto& nodes = grid.topology().nodes;
  ASSERT_EQ(nodes.size(), 1U + 3 * 5 * 7);
  EXPECT_FALSE(nodes[0].leaf);
  EXPECT_EQ(nodes[0].first, 1U);
  EXPECT_EQ(nodes[0].count, 105U);
  std::uint32_t next_entry = 0;
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    ASSERT_TRUE(nodes[n].leaf);
    ASSERT_EQ(nodes[n].level, 2);
    ASSERT_EQ(nodes[n].first, next_entry);
    next_entry += nodes[n].count;
  }
  EXPECT_EQ(next_entry, grid.topology().entries.size());
}

TEST(Grid, CellsListWhatMeetsThem) {
  for (const double offset : {0.0, 1e6}) {
    const Grid grid = Grid::build(set_of(tests::hostile_soup(offset, 2)), with({9, 16, 5}));
    check_lists(grid, boxes_of(grid));
  }
}

// The walk against looking at every cell.
TEST(Grid, WalksFrontToBackThroughTheCellsOnTheRay) {
  for (const auto& resolution : {std::array<std::uint32_t, 3>{16, 16, 16}, {13, 1, 40}}) {
    const Grid grid = Grid::build(set_of(tests::hostile_soup(0.0, 4)), with(resolution));
    const int most = static_cast<int>(resolution[0] + resolution[1] + resolution[2]);
    EXPECT_GT(check_walks(grid, boxes_of(grid), most), test::cases(20000U));
  }
}

TEST(Grid, CountingChangesNothing) { check_counting(Grid::build(set_of(tests::hostile_soup(0.0, 8)))); }

/// Whether the ray takes the slow walk, which goes through slices and rows of enlarged cells instead of from
/// neighbour to neighbour (start_walk in octree_start.h): so fast or so slow that its parameters lose digits.
/// Those from afar are another aim.
bool walks_slowly(const accel::Ray& ray) {
  const double speed = studies::stability::largest(ray.direction);
  return !(speed >= 0x1p-500 && speed <= 0x1p500);
}

// Each step goes to a neighbour across one face, also where the ray passes through edges and corners.
TEST(Grid, StepsAreAlongOneAxis) {
  const Grid grid = Grid::build(set_of(tests::hostile_soup(0.0, 4)), with({8, 8, 8}));
  for (std::uint64_t seed = 1; seed <= test::stride(5, 100); ++seed) {
    RayMaker maker(grid.triangles(), grid.bounds(), seed);
    for (std::size_t k = 0; k < 20000; ++k) {
      const Aim aim = tests::all_aims[k % tests::all_aims.size()];
      const accel::Ray ray = maker.make(aim);
      if (aim == Aim::far || walks_slowly(ray)) {
        continue;
      }
      Recorder recorder;
      (void)grid.closest(ray, recorder);
      ASSERT_NE(recorder.visits.size(), 1U);
      ASSERT_LE(recorder.visits.size(), 1U + 22U);
      for (std::size_t i = 2; i < recorder.visits.size(); ++i) {
        const std::uint32_t from = recorder.visits[i - 1].node;
        const std::uint32_t to = recorder.visits[i].node;
        const std::uint32_t apart = from < to ? to - from : from - to;
        ASSERT_TRUE(apart == 1 || apart == 8 || apart == 64) << from << " to " << to << ", seed " << seed;
      }
    }
  }
}

TEST(Grid, ResolutionFollowsDensity) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 1));
  for (const double density : {0.1, 1.0, 4.0, 50.0}) {
    GridOptions options;
    options.density = density;
    const Grid grid = Grid::build(triangles, options);
    const double cells = static_cast<double>(grid.topology().nodes.size() - 1);
    EXPECT_NEAR(cells / (density * triangles->size()), 1.0, 0.4) << density;
  }
}

TEST(Grid, FlatScenesHaveOneCellAcross) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<TriangleCorners> sheet = tests::hostile_soup(0.0, 1);
    for (TriangleCorners& triangle : sheet) {
      for (std::size_t k = 0; k < 3; ++k) {
        triangle[3 * k + static_cast<std::size_t>(axis)] = 0.25;
      }
    }
    const Grid grid = Grid::build(set_of(sheet));
    EXPECT_EQ(grid.resolution()[static_cast<std::size_t>(axis)], 1U);
    EXPECT_GT(grid.resolution()[static_cast<std::size_t>((axis + 1) % 3)], 10U);
  }
}

TEST(Grid, StaysWithinItsLimits) {
  const auto triangles =
      set_of(std::vector<TriangleCorners>(1000, tests::corners({-1, -1, -1}, {1, 0.3, 0.2}, {0, 1, 1})));
  GridOptions options;
  options.max_entries = 5000;
  const Grid grid = Grid::build(triangles, options);
  EXPECT_LE(grid.topology().entries.size(), options.max_entries);
  options.max_entries = 1;  // one cell lists what there is
  EXPECT_EQ(Grid::build(triangles, options).topology().entries.size(), 1000U);
  options = with({100, 100, 100});
  options.max_cells = 5000;
  EXPECT_LE(Grid::build(triangles, options).topology().nodes.size(), 5001U);
}

TEST(Grid, RefusesOptionsOutOfRange) {
  const auto triangles = set_of(tests::hostile_soup(0.0, 5));
  const auto refused = [&](auto change) {
    GridOptions options;
    change(options);
    EXPECT_THROW((void)Grid::build(triangles, options), sim::UserError);
  };
  refused([](GridOptions& o) { o.density = 0.0; });
  refused([](GridOptions& o) { o.density = std::numeric_limits<double>::quiet_NaN(); });
  refused([](GridOptions& o) { o.density = 1e9; });
  refused([](GridOptions& o) { o.resolution = {1, 1, 2000000}; });
  refused([](GridOptions& o) { o.max_cells = 0; });
  refused([](GridOptions& o) { o.max_entries = 0; });
}

}  // namespace
}  // namespace marti::tests
