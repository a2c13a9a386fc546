#include "studies/estimate/regression_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/error.h"

namespace marti::studies::estimate {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Of how many units each of the strata's chosen ones stands for.
std::vector<double> weights_of(std::span<const Stratum> strata) {
  std::vector<double> weights;
  for (const Stratum& stratum : strata) {
    const auto chosen = static_cast<double>(stratum.chosen.size());
    weights.insert(weights.end(), stratum.chosen.size(), static_cast<double>(stratum.size()) / chosen);
  }
  return weights;
}

// What an expected miss adds to what the hit time explains already: the slope of `measured`
// over the misses, both less what is proportional to the hit time. 0 where all misses are proportional to it.
double slope_of_misses(std::span<const double> weights, std::span<const KnownWork> known,
                       std::span<const double> measured, double misses_of_time) {
  double products = 0.0;
  double squares = 0.0;
  double all_squares = 0.0;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const KnownWork& unit = known[i];
    if (unit.hit_time > 0.0) {
      const double beside = unit.misses - misses_of_time * unit.hit_time;
      products += weights[i] * beside * measured[i] / unit.hit_time;
      squares += weights[i] * beside * beside / unit.hit_time;
      all_squares += weights[i] * unit.misses * unit.misses / unit.hit_time;
    }
  }
  constexpr double rounding = 1e-12;
  return squares > rounding * all_squares ? products / squares : 0.0;
}

}  // namespace

RegressionEstimate regression_estimate(std::span<const Stratum> strata, std::span<const KnownWork> known,
                                       std::span<const double> measured, const KnownWork& all) {
  double sum_measured = 0.0;
  KnownWork sum;
  const std::vector<double> weights = weights_of(strata);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum_measured += weights[i] * measured[i];
    sum.hit_time += weights[i] * known[i].hit_time;
    sum.misses += weights[i] * known[i].misses;
  }
  RegressionEstimate estimate;
  estimate.total = sum_measured;
  estimate.residues.assign(measured.size(), 0.0);
  if (all_chosen(strata)) {
    return estimate;
  }
  estimate.half_width = infinite;
  if (sum.hit_time <= 0.0) {
    return estimate;
  }
  const double misses_of_time = sum.misses / sum.hit_time;
  const double slope = slope_of_misses(weights, known, measured, misses_of_time);
  estimate.counts_for = {sum_measured / sum.hit_time - slope * misses_of_time, slope};
  const auto counted = [&](const KnownWork& work) {
    return estimate.counts_for.hit_time * work.hit_time + estimate.counts_for.misses * work.misses;
  };
  for (std::size_t i = 0; i < measured.size(); ++i) {
    estimate.residues[i] = measured[i] - counted(known[i]);
  }
  estimate.total = std::max(0.0, counted(all));
  const std::uint64_t taken = strata.size() + (slope != 0.0 ? 1 : 0);
  if (measured.size() > taken && sum_measured > 0.0 && estimate.total > 0.0) {
    estimate.degrees = measured.size() - taken;
    estimate.half_width = half_width_of(strata, estimate.residues, estimate.degrees) / estimate.total;
  }
  return estimate;
}

double student_95(std::uint64_t degrees) {
  sim::ensure(degrees > 0, "Student's distribution has no 0 degrees of freedom");
  constexpr std::array table = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                                2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
                                2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
  if (degrees <= table.size()) {
    return table[degrees - 1];
  }
  // Cornish-Fisher expansion around the normal point (M. Abramowitz, I. A. Stegun, 1964, formula 26.7.5).
  constexpr double z = 1.959963984540054;
  const auto n = static_cast<double>(degrees);
  const double z3 = z * z * z;
  const double z5 = z3 * z * z;
  return z + (z3 + z) / (4.0 * n) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n);
}

double half_width_of(std::span<const Stratum> strata, std::span<const double> residues,
                     std::uint64_t degrees) {
  double variance = 0.0;
  std::size_t at = 0;
  for (const Stratum& stratum : strata) {
    const auto n = static_cast<double>(stratum.chosen.size());
    const auto size = static_cast<double>(stratum.size());
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < stratum.chosen.size(); ++i, ++at) {
      sum += residues[at];
      squares += residues[at] * residues[at];
    }
    if (stratum.chosen.size() > 1) {
      const double spread = std::max(0.0, (squares - sum * sum / n) / (n - 1.0));
      variance += size * size * (1.0 - n / size) * spread / n;
    }
  }
  return student_95(degrees) * std::sqrt(variance);
}

}  // namespace marti::studies::estimate
