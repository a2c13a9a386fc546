// What intervals of samples are widened by: conformal quantiles, by class, and how many cases they cover.
#include "bench/estimates/allowances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "studies/estimate/measured_errors.h"

namespace marti::studies {

using namespace estimate;

namespace {

TEST(Quantile, IsTheConformalRank) {
  std::vector<double> values(39);
  std::iota(values.begin(), values.end(), 1.0);
  EXPECT_EQ(bench::upper_quantile(values, 0.95), 38.0);  // 0.95 * 40
  EXPECT_EQ(bench::upper_quantile({3.0, 1.0}, 0.95), 3.0);
  EXPECT_EQ(bench::upper_quantile({1.0}, 0.1), 1.0);
}

// A new value of the same distribution exceeds it seldom enough.
TEST(Quantile, CoversANewValue) {
  std::mt19937_64 random(7);
  std::exponential_distribution<double> draw;
  int covered = 0;
  constexpr int trials = 4000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> values(30);
    std::generate(values.begin(), values.end(), [&] { return draw(random); });
    covered += draw(random) <= bench::upper_quantile(values, 0.95) ? 1 : 0;
  }
  EXPECT_GE(covered, trials * 93 / 100);
}

bench::MeasuredSample sample(std::size_t scene, std::size_t load, double error, double interval) {
  bench::MeasuredSample made{scene, false, load, 0, {}, {}};
  made.error.values.fill(error);
  made.interval.values.fill(interval);
  return made;
}

TEST(Allowances, AreWhatErrorsExceedTheIntervalsOfTheirClassBy) {
  std::vector<bench::MeasuredSample> samples = {
      sample(0, 1, -0.05, 0.02), sample(0, 1, 0.01, 0.02), sample(1, 1, 0.04, 0.03),
      sample(1, 1, 0.9, std::numeric_limits<double>::infinity()), sample(1, 2, 0.5, 0.1)};
  samples[1].one_node = true;
  const auto found = bench::allowance_of(samples, 1, 0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cases, 3U);
  EXPECT_DOUBLE_EQ(found->allowance[Figure::end], 0.05 - 0.02);
  // Scene 1 says 0.01, which covers the second case of scene 0 but not the first; scene 0 covers scene 1. Of
  // the speed-up the second case, of one node, is left out.
  EXPECT_DOUBLE_EQ(found->covered, 1.0 / 2.0);
  EXPECT_EQ(bench::allowance_of(samples, 2, 0)->covered, 0.0);
  EXPECT_FALSE(bench::allowance_of(samples, 0, 0));
  EXPECT_FALSE(bench::allowance_of(samples, 1, 1));
}

TEST(Allowances, ErrorsAreRelativeButForTheUseOfTheInterconnect) {
  EXPECT_DOUBLE_EQ(bench::error_of(Figure::end, 3.0, 2.0), 0.5);
  EXPECT_DOUBLE_EQ(bench::error_of(Figure::use, 0.75, 0.5), 0.25);
  EXPECT_EQ(bench::error_of(Figure::misses, 0.0, 0.0), 0.0);
  EXPECT_TRUE(std::isinf(bench::error_of(Figure::misses, 1.0, 0.0)));
}

TEST(Allowances, OfTheProgramHaveAClassForEveryLoadAndSize) {
  for (std::size_t load = 0; load < load_classes.size(); ++load) {
    EXPECT_EQ(load_class_of(load_classes[load]), load);
    for (const MachineFigures& allowance : measured_allowances[load]) {
      EXPECT_TRUE(std::ranges::all_of(allowance.values, [](double value) { return value >= 0.0; }));
    }
  }
  EXPECT_EQ(load_class_of(0.0), 0U);
  EXPECT_EQ(load_class_of(0.31), 1U);
  EXPECT_EQ(load_class_of(1.01), load_classes.size() - 1);
  EXPECT_EQ(size_class_of(32), 0U);
  EXPECT_EQ(size_class_of(63), 0U);
  EXPECT_EQ(size_class_of(64), 1U);
  EXPECT_EQ(size_class_of(4096), 1U);
}

}  // namespace
}  // namespace marti::studies
