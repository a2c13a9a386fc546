// The regression estimator: least squares by the normal equations, its limits, and whether its intervals
// hold.
#include "studies/estimate/regression_estimate.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace marti::studies {

using namespace estimate;

namespace {

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

KnownWork sum(const std::vector<KnownWork>& known) {
  KnownWork all;
  for (const KnownWork& unit : known) {
    all.hit_time += unit.hit_time;
    all.misses += unit.misses;
  }
  return all;
}

template <class Value>
std::vector<Value> chosen_of(const std::vector<Stratum>& strata, const std::vector<Value>& values) {
  std::vector<Value> chosen;
  for (const Stratum& stratum : strata) {
    for (const std::uint64_t unit : stratum.chosen) {
      chosen.push_back(values[unit]);
    }
  }
  return chosen;
}

// Units whose time follows what is known of them, but for noise.
struct Units {
  std::vector<KnownWork> known;
  std::vector<double> times;
};

Units random_units(std::mt19937_64& random, std::uint64_t units, double noise) {
  std::normal_distribution<double> normal;
  Units all;
  for (std::uint64_t i = 0; i < units; ++i) {
    const auto hit_time = static_cast<double>(50 + random() % 400);
    const auto misses = static_cast<double>(random() % (1 + i));
    all.known.push_back({hit_time, misses});
    all.times.push_back((7.0 * hit_time + 3.0 * misses) * std::exp(noise * normal(random)));
  }
  return all;
}

// The sum of squares of residues over hit times, weighted, is least: both of its derivatives are 0.
RC_GTEST_PROP(RegressionEstimate, IsTheWeightedLeastSquaresFit, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Units units = random_units(random, 60, 0.3);
  const std::vector<Stratum> strata = draw_strata(60, 7, seed);
  const std::vector<KnownWork> known = chosen_of(strata, units.known);
  const std::vector<double> times = chosen_of(strata, units.times);
  const RegressionEstimate estimate = regression_estimate(strata, known, times, sum(units.known));
  double by_time = 0.0;
  double by_misses = 0.0;
  double size = 0.0;
  std::size_t at = 0;
  for (const Stratum& stratum : strata) {
    const double weight = static_cast<double>(stratum.size()) / static_cast<double>(stratum.chosen.size());
    for (std::size_t i = 0; i < stratum.chosen.size(); ++i, ++at) {
      const double residue = times[at] - estimate.counts_for.hit_time * known[at].hit_time -
                             estimate.counts_for.misses * known[at].misses;
      RC_ASSERT(std::abs(residue - estimate.residues[at]) <= 1e-9 * times[at]);
      by_time += weight * residue;
      by_misses += weight * residue * known[at].misses / known[at].hit_time;
      size += weight * times[at];
    }
  }
  RC_ASSERT(std::abs(by_time) <= 1e-9 * size);
  RC_ASSERT(std::abs(by_misses) <= 1e-9 * size);
  const KnownWork all = sum(units.known);
  const double total = estimate.counts_for.hit_time * all.hit_time + estimate.counts_for.misses * all.misses;
  RC_ASSERT(std::abs(estimate.total - total) <= 1e-9 * total);
}

TEST(RegressionEstimate, WhatFollowsFromTheKnownIsKnown) {
  std::mt19937_64 random(4);
  const Units units = random_units(random, 100, 0.0);
  const std::vector<Stratum> strata = draw_strata(100, 8, 1);
  const RegressionEstimate estimate = regression_estimate(strata, chosen_of(strata, units.known),
                                                          chosen_of(strata, units.times), sum(units.known));
  EXPECT_NEAR(estimate.total, sum(units.times), 1e-6);
  EXPECT_NEAR(estimate.counts_for.hit_time, 7.0, 1e-9);
  EXPECT_NEAR(estimate.counts_for.misses, 3.0, 1e-9);
  EXPECT_NEAR(estimate.half_width, 0.0, 1e-9);
  EXPECT_EQ(estimate.degrees, 7U);
}

// Where all misses are in proportion to the time, or none are expected, the ratio to the time is all there
// is.
TEST(RegressionEstimate, WithoutOtherMissesItIsTheRatio) {
  std::mt19937_64 random(9);
  Units units = random_units(random, 90, 0.3);
  const std::vector<Stratum> strata = draw_strata(90, 9, 2);
  for (const double share : {0.0, 0.25}) {
    for (KnownWork& unit : units.known) {
      unit.misses = share * unit.hit_time;
    }
    const KnownWork all = sum(units.known);
    const std::vector<double> times = chosen_of(strata, units.times);
    const RegressionEstimate estimate =
        regression_estimate(strata, chosen_of(strata, units.known), times, all);
    const double ratio = sum(times) / sum(chosen_of(strata, units.known)).hit_time;  // strata of equal size
    EXPECT_NEAR(estimate.total, ratio * all.hit_time, 1e-6 * estimate.total);
    EXPECT_EQ(estimate.counts_for.misses, 0.0);
    EXPECT_EQ(estimate.degrees, 9U);
  }
}

TEST(RegressionEstimate, ItsIntervalCoversTheTotal) {
  std::mt19937_64 random(11);
  constexpr std::uint64_t count_of_units = 600;
  const Units units = random_units(random, count_of_units, 0.2);
  for (const std::uint64_t count : {8, 30, 100}) {
    int covered = 0;
    constexpr int trials = 400;
    for (int trial = 0; trial < trials; ++trial) {
      const std::vector<Stratum> strata =
          draw_strata(count_of_units, count, static_cast<std::uint64_t>(trial));
      const RegressionEstimate estimate = regression_estimate(
          strata, chosen_of(strata, units.known), chosen_of(strata, units.times), sum(units.known));
      covered += std::abs(estimate.total / sum(units.times) - 1.0) <= estimate.half_width ? 1 : 0;
    }
    EXPECT_GE(covered, trials * 9 / 10) << count;
  }
}

TEST(RegressionEstimate, AllUnitsAreTheTotal) {
  const std::vector<KnownWork> known = {{1.0, 4.0}, {2.0, 0.0}, {3.0, 1.0}, {4.0, 2.0}};
  const std::vector<double> times = {9.0, 7.0, 1.0, 2.0};
  const RegressionEstimate estimate = regression_estimate(draw_strata(4, 2, 1), known, times, sum(known));
  EXPECT_EQ(estimate.total, 19.0);
  EXPECT_EQ(estimate.half_width, 0.0);
  EXPECT_EQ(estimate.residues, std::vector<double>(4));
}

TEST(RegressionEstimate, WithoutAnythingKnownOrMeasuredNothingIsSure) {
  const std::vector<Stratum> strata = draw_strata(10, 2, 1);
  const std::vector<KnownWork> nothing(4);
  const std::vector<KnownWork> some(4, {1.0, 0.0});
  const std::vector<double> none(4, 0.0);
  const std::vector<double> times(4, 1.0);
  EXPECT_TRUE(std::isinf(regression_estimate(strata, nothing, times, {10.0, 0.0}).half_width));
  EXPECT_TRUE(std::isinf(regression_estimate(strata, some, none, {10.0, 0.0}).half_width));
  const std::vector<Stratum> one = draw_strata(1, 1, 1);
  EXPECT_EQ(regression_estimate(one, std::vector<KnownWork>{{2.0, 1.0}}, std::vector{3.0}, {2.0, 1.0}).total,
            3.0);
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

}  // namespace
}  // namespace marti::studies
