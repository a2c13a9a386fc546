// Several samples a pixel: their places, their weights, their words in the log, and that every scheme
// times such logs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "processors/program/log_rules.h"
#include "processors/program/sample_points.h"
#include "processors/replay/replay.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/support/logged_samples.h"
#include "tests/unit/processors/program_scenes.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;
using test::same_bytes;

TEST(SamplePoints, OneLiesInTheCentreWhateverTheSeed) {
  for (const std::uint64_t seed : {0, 1, 77}) {
    const SamplePoint point = SamplePoints(1, seed).at(3, 32767, 0);
    EXPECT_EQ(point.column, 3.5);
    EXPECT_EQ(point.row, 32767.5);
  }
}

TEST(SamplePoints, EachLiesInItsOwnCell) {
  for (const auto& [samples, columns] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {2, 1}, {4, 2}, {6, 2}, {7, 1}, {12, 3}, {64, 8}, {1024, 32}}) {
    const SamplePoints points(samples, 5);
    ASSERT_EQ(points.columns(), columns);
    const std::uint32_t rows = samples / columns;
    std::set<std::pair<int, int>> cells;
    for (std::uint32_t sample = 0; sample < samples; ++sample) {
      const SamplePoint point = points.at(10, 20, sample);
      const double column = (point.column - 10.0) * columns;
      const double row = (point.row - 20.0) * rows;
      ASSERT_TRUE(column >= 0.0 && column <= columns && row >= 0.0 && row <= rows);
      cells.insert({static_cast<int>(column), static_cast<int>(row)});
    }
    EXPECT_EQ(cells.size(), samples);
  }
}

TEST(SamplePoints, NumbersDependOnEverythingTheyAreCountedBy) {
  const double number = counted_number(1, 2, 3, 0, 4);
  std::set<double> others = {number,
                             counted_number(2, 2, 3, 0, 4),
                             counted_number(1, 3, 3, 0, 4),
                             counted_number(1, 2, 4, 0, 4),
                             counted_number(1, 2, 3, 1, 4),
                             counted_number(1, 2, 3, 0, 5)};
  EXPECT_EQ(others.size(), 6U);
  EXPECT_EQ(number, counted_number(1, 2, 3, 0, 4));
  double sum = 0.0;
  double squares = 0.0;
  constexpr std::uint32_t side = 128;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double u = counted_number(i % side, i / side, 0, 0, 1);
    ASSERT_TRUE(u >= 0.0 && u < 1.0);
    sum += u;
    squares += u * u;
  }
  // Mean and mean square of a uniform number, within five standard errors.
  EXPECT_NEAR(sum / (side * side), 0.5, 5.0 * std::sqrt(1.0 / 12.0) / side);
  EXPECT_NEAR(squares / (side * side), 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0) / side);
}

/// A triangle of light that covers part of the one pixel, which is the square |x|, |y| <= 0.5.
scenes::Scene partly_covered(double left, double right) {
  scenes::Scene scene = test::looking_down(0.5);
  scene.camera.vertical_fov = std::numbers::pi / 2.0;
  scene.materials.emplace_back();
  scene.materials[0].emission = {1.0, 1.0, 1.0};
  scene.materials[0].diffuse = 0.0;
  // Everything left of the line from (left, -0.5) to (right, 0.5).
  test::add_quad(scene, {-9.0, -0.5, 0.0}, {left, -0.5, 0.0}, {right, 0.5, 0.0}, {-9.0, 0.5, 0.0}, 0);
  return scene;
}

TEST(Samples, TheirMeanOverSeedsIsTheCoveredArea) {
  const Built built(partly_covered(-0.3, 0.1));
  RenderOptions options = test::one_pixel();
  constexpr double area = 0.4;  // (0.2 + 0.6) / 2
  for (const std::uint32_t samples : {2U, 9U, 16U}) {
    options.samples = samples;
    constexpr int seeds = 400;
    double sum = 0.0;
    double squares = 0.0;
    for (options.seed = 0; options.seed < seeds; ++options.seed) {
      const double value = built.render(options).image.pixels[0].x;
      sum += value;
      squares += (value - area) * (value - area);
    }
    // Independent samples would have this standard deviation, those of a grid's cells have less.
    const double independent = std::sqrt(area * (1.0 - area) / samples);
    EXPECT_NEAR(sum / seeds, area, 5.0 * independent / std::sqrt(seeds)) << samples;
    EXPECT_LT(std::sqrt(squares / seeds), samples == 2 ? 1.01 * independent : 0.8 * independent) << samples;
  }
}

TEST(Samples, TheWeightCutIsOfASampleAndNotOfItsShareOfThePixel) {
  scenes::Scene scene = test::looking_down(2.0);
  scene.materials.emplace_back();
  scene.materials[0].reflection = 0.5;
  test::add_floor(scene, 0.0, 100.0, 0);
  const Built built(std::move(scene));
  RenderOptions options{.width = 3, .height = 3, .max_depth = 2, .min_weight = 0.5, .samples = 8};
  EXPECT_EQ(built.render(options).rays.traced[2], 9U * 8U);
  options.min_weight = 0.51;
  EXPECT_EQ(built.render(options).rays.traced[2], 0U);
}

TEST(Floats, DifferFromDoublesByRoundingInMostPixels) {
  for (const char* scene : {"balls:1", "gears:1"}) {
    const Built built(scenes::make_procedural(scene), "octree");
    RenderOptions options{.width = 40, .height = 40, .max_depth = 2, .record = true};
    const Frame doubles = built.render(options);
    options.floats = true;
    const Frame floats = built.render(options);
    ASSERT_EQ(program::fault_of(*floats.log), "");
    std::size_t equal = 0;
    std::size_t far = 0;
    for (std::size_t i = 0; i < floats.image.pixels.size(); ++i) {
      const glm::vec3 difference = floats.image.pixels[i] - doubles.image.pixels[i];
      const float largest =
          std::max({std::abs(difference.x), std::abs(difference.y), std::abs(difference.z)});
      equal += largest == 0.0F ? 1U : 0U;
      far += largest > 1e-3F ? 1U : 0U;
    }
    EXPECT_LT(equal, floats.image.pixels.size()) << scene;
    EXPECT_LT(far, floats.image.pixels.size() / 50) << scene << ": edges that flip";
    options.voxel_cut = 1.0;
    EXPECT_THROW((void)built.render(options), sim::UserError);
  }
}

}  // namespace
}  // namespace marti::processors
