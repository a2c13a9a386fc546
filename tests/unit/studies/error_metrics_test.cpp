// Rank correlation, regret, Pareto fronts, quantiles and curves against brute force and known values.
#include "studies/estimate/error_metrics.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "sim/error.h"
#include "studies/estimate/simulator_interpolation.h"

namespace marti::studies {

using namespace estimate;

namespace {

std::vector<double> random_values(std::mt19937_64& random, std::size_t count, int most) {
  std::vector<double> values(count);
  std::generate(values.begin(), values.end(), [&] { return static_cast<double>(random() % most + 1); });
  return values;
}

TEST(Kendall, KnownValues) {
  const std::vector<double> up = {1, 2, 3, 4};
  const std::vector<double> down = {9, 7, 5, 3};
  const std::vector<double> swapped = {1, 3, 2, 4};
  const std::vector<double> flat = {5, 5, 5, 5};
  EXPECT_DOUBLE_EQ(*kendall_tau(up, up), 1.0);
  EXPECT_DOUBLE_EQ(*kendall_tau(up, down), -1.0);
  EXPECT_DOUBLE_EQ(*kendall_tau(up, swapped), 4.0 / 6.0);
  EXPECT_FALSE(kendall_tau(up, flat));
  // Kendall 1945: ties in one list.
  const std::vector<double> tied = {1, 2, 2, 3};
  EXPECT_DOUBLE_EQ(*kendall_tau(up, tied), 5.0 / std::sqrt(6.0 * 5.0));
  EXPECT_THROW((void)kendall_tau(up, std::vector<double>{1.0}), sim::InternalError);
}

// Without ties, tau is 1 less four times the exchanges of neighbours that sort one list, over n (n - 1).
RC_GTEST_PROP(Kendall, CountsExchanges, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const std::size_t n = 2 + random() % 20;
  std::vector<double> a(n);
  std::iota(a.begin(), a.end(), 1.0);
  std::vector<double> b = a;
  std::shuffle(b.begin(), b.end(), random);
  const double tau = *kendall_tau(a, b);
  double exchanges = 0.0;
  for (std::size_t pass = 0; pass < n; ++pass) {
    for (std::size_t i = 0; i + 1 < n; ++i) {
      if (b[i] > b[i + 1]) {
        std::swap(b[i], b[i + 1]);
        exchanges += 1.0;
      }
    }
  }
  RC_ASSERT(std::abs(tau - (1.0 - 4.0 * exchanges / static_cast<double>(n * (n - 1)))) < 1e-12);
}

RC_GTEST_PROP(Regret, IsOfTheChosenOne, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const std::size_t n = 1 + random() % 20;
  const std::vector<double> truth = random_values(random, n, 50);
  const std::vector<double> estimate = random_values(random, n, 50);
  RC_ASSERT(regret(truth, truth) == 0.0);
  std::size_t chosen = 0;
  double best = truth[0];
  for (std::size_t i = 0; i < n; ++i) {
    chosen = estimate[i] < estimate[chosen] ? i : chosen;
    best = std::min(best, truth[i]);
  }
  RC_ASSERT(regret(truth, estimate) == truth[chosen] / best - 1.0);
}

TEST(Summary, MeanSizeAndWorst) {
  const std::vector<double> errors = {0.1, -0.3, 0.2};
  const ErrorSummary summary = summarise(errors);
  EXPECT_NEAR(summary.mean, 0.0, 1e-15);
  EXPECT_NEAR(summary.mean_abs, 0.2, 1e-15);
  EXPECT_EQ(summary.worst, -0.3);
  EXPECT_EQ(summary.worst_case, 1U);
}

TEST(Quantile, IsTheConformalRank) {
  std::vector<double> values(39);
  std::iota(values.begin(), values.end(), 1.0);
  EXPECT_EQ(upper_quantile(values, 0.95), 38.0);  // 0.95 * 40
  EXPECT_EQ(upper_quantile({3.0, 1.0}, 0.95), 3.0);
  EXPECT_EQ(upper_quantile({1.0}, 0.1), 1.0);
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
    covered += draw(random) <= upper_quantile(values, 0.95) ? 1 : 0;
  }
  EXPECT_GE(covered, trials * 93 / 100);
}

TEST(Student, KnownPoints) {
  EXPECT_NEAR(student_95(1), 12.706, 5e-4);
  EXPECT_NEAR(student_95(10), 2.228, 5e-4);
  EXPECT_NEAR(student_95(40), 2.0211, 5e-4);
  EXPECT_NEAR(student_95(120), 1.9799, 5e-4);
  EXPECT_NEAR(student_95(1'000'000), 1.95996, 5e-4);
  for (std::uint64_t n = 1; n < 200; ++n) {
    EXPECT_GT(student_95(n), student_95(n + 1)) << n;
  }
}

TEST(Median, OfOddAndEven) {
  const MedianInterval odd = median_interval({5.0, 1.0, 3.0});
  EXPECT_EQ(odd.median, 3.0);
  EXPECT_EQ(odd.low, 1.0);
  EXPECT_EQ(odd.high, 5.0);
  EXPECT_DOUBLE_EQ(odd.confidence, 0.75);
  EXPECT_EQ(median_interval({1.0, 2.0}).median, 1.5);
  EXPECT_EQ(median_interval({4.0}).confidence, 0.0);
}

RC_GTEST_PROP(Interpolation, PassesThroughItsPointsAndStaysBetweenThem, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const std::size_t n = 2 + random() % 6;
  std::vector<double> xs(n);
  double x = 0.0;
  for (double& value : xs) {
    value = x += static_cast<double>(1 + random() % 9);
  }
  const std::vector<double> ys = random_values(random, n, 100);
  for (const Curve curve : {Curve::linear, Curve::cubic}) {
    for (std::size_t i = 0; i < n; ++i) {
      RC_ASSERT(interpolate(curve, xs, ys, xs[i]) == ys[i]);
    }
    for (std::size_t i = 0; i + 1 < n; ++i) {
      for (const double t : {0.1, 0.3, 0.5, 0.8}) {
        const double y = interpolate(curve, xs, ys, xs[i] + t * (xs[i + 1] - xs[i]));
        RC_ASSERT(y >= std::min(ys[i], ys[i + 1]) - 1e-9);
        RC_ASSERT(y <= std::max(ys[i], ys[i + 1]) + 1e-9);
      }
    }
  }
}

TEST(Interpolation, StraightLinesAreExactByBothCurves) {
  const std::vector<double> xs = {1.0, 2.0, 4.0, 8.0};
  const std::vector<double> ys = {3.0, 5.0, 9.0, 17.0};
  for (const double x : {1.5, 3.0, 7.9}) {
    EXPECT_NEAR(interpolate(Curve::linear, xs, ys, x), 2.0 * x + 1.0, 1e-12);
    EXPECT_NEAR(interpolate(Curve::cubic, xs, ys, x), 2.0 * x + 1.0, 1e-12);
  }
}

// A power law is a straight line of logarithms.
TEST(Interpolation, PowerLawsBetweenMachinesAreExact) {
  const std::vector<double> nodes = {1.0, 4.0, 64.0};
  std::vector<MachineFigures> machines(3);
  for (std::size_t i = 0; i < 3; ++i) {
    machines[i][Figure::end] = 1e12 / nodes[i];
    machines[i][Figure::misses] = 1000.0 * std::sqrt(nodes[i]);
    machines[i][Figure::wait] = std::log(nodes[i]);  // 0 with one node
  }
  for (const Curve curve : {Curve::linear, Curve::cubic}) {
    const Estimate between = estimate_between(curve, nodes, machines, 16.0);
    EXPECT_NEAR(between.value[Figure::end], 1e12 / 16.0, 1e-2);
    EXPECT_NEAR(between.value[Figure::misses], 4000.0, 1e-9);
    EXPECT_NEAR(between.value[Figure::wait], std::log(16.0), 1e-12);
    EXPECT_EQ(estimate_between(curve, nodes, machines, 4.0).value, machines[1]);
  }
}

}  // namespace
}  // namespace marti::studies
