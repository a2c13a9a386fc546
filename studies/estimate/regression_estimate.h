// The total of something measured of a sample of units, with the help of what is known of every unit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "studies/estimate/packet_windows.h"

namespace marti::studies::estimate {

/// What is known of a unit, or of several: the time that they take if every reference hits, and the misses
/// that are expected of them.
struct KnownWork {
  double hit_time = 0.0;
  double misses = 0.0;
};

struct RegressionEstimate {
  double total = 0.0;
  double half_width = 0.0;       ///< of the 95 % interval, relative to the total
  KnownWork counts_for;          ///< what a unit of time and an expected miss count for in the total
  std::vector<double> residues;  ///< of each chosen unit: measured, less what its known work counts for
  std::uint64_t degrees = 0;     ///< of freedom
};

/// The regression estimator for strata (W. G. Cochran, "Sampling techniques", 3rd ed. 1977, sections 7.7 to
/// 7.10): `known` and `measured` of the strata's chosen units, in order, `all` what is known of all units
/// together. The spread of a unit's residue is taken to grow with the root of its hit time, which makes it
/// the combined ratio estimator (6.11 there) where no misses are expected. The interval takes Student's
/// distribution, with chosen units less strata, and less one where expected misses count, as its degrees of
/// freedom. If all units are chosen, the result is the total, with half-width 0; without a degree of freedom,
/// or where nothing is known or measured, the half-width is infinite.
[[nodiscard]] RegressionEstimate regression_estimate(std::span<const Stratum> strata,
                                                     std::span<const KnownWork> known,
                                                     std::span<const double> measured, const KnownWork& all);

/// The two-sided 95 % point of Student's distribution, from 1 degree of freedom on (12.706, 4.303, ...).
[[nodiscard]] double student_95(std::uint64_t degrees);

/// Half of the 95 % interval of a total whose chosen units have these residues.
[[nodiscard]] double half_width_of(std::span<const Stratum> strata, std::span<const double> residues,
                                   std::uint64_t degrees);

}  // namespace marti::studies::estimate
