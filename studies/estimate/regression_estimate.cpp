#include "studies/estimate/regression_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/estimate/error_metrics.h"

namespace marti::studies::estimate {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Calls use(weight, i) for the strata's chosen units, with the number of units that each stands for.
template <class Use>
void for_each_weighted(std::span<const Stratum> strata, const Use& use) {
  std::size_t at = 0;
  for (const Stratum& stratum : strata) {
    const double weight = static_cast<double>(stratum.size()) / static_cast<double>(stratum.chosen.size());
    for (std::size_t i = 0; i < stratum.chosen.size(); ++i) {
      use(weight, at++);
    }
  }
}

// What an expected miss adds to what the hit time explains already: the slope of `measured`
// over the misses, both less what is proportional to the hit time. 0 where all misses are proportional to it.
double slope_of_misses(std::span<const Stratum> strata, std::span<const KnownWork> known,
                       std::span<const double> measured, double misses_of_time) {
  double products = 0.0;
  double squares = 0.0;
  double all_squares = 0.0;
  for_each_weighted(strata, [&](double weight, std::size_t i) {
    const KnownWork& unit = known[i];
    if (unit.hit_time > 0.0) {
      const double beside = unit.misses - misses_of_time * unit.hit_time;
      products += weight * beside * measured[i] / unit.hit_time;
      squares += weight * beside * beside / unit.hit_time;
      all_squares += weight * unit.misses * unit.misses / unit.hit_time;
    }
  });
  constexpr double rounding = 1e-12;
  return squares > rounding * all_squares ? products / squares : 0.0;
}

}  // namespace

RegressionEstimate regression_estimate(std::span<const Stratum> strata, std::span<const KnownWork> known,
                                       std::span<const double> measured, const KnownWork& all) {
  double sum_measured = 0.0;
  KnownWork sum;
  for_each_weighted(strata, [&](double weight, std::size_t i) {
    sum_measured += weight * measured[i];
    sum.hit_time += weight * known[i].hit_time;
    sum.misses += weight * known[i].misses;
  });
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
  const double slope = slope_of_misses(strata, known, measured, misses_of_time);
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
