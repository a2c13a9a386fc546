// How much work advice takes at the end of a sweep: the loop's estimate and the advice itself
// (sweep/advise.h) must agree.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace marti::studies::sweep {

inline constexpr std::size_t least_advised = 2;  ///< machines, if there are so many that matter
/// For one machine, in about a nanosecond of one processor: half a second.
inline constexpr std::uint64_t least_advice_work = 500'000'000;
inline constexpr std::uint64_t advice_part_of_sweep = 10;

/// Seconds of processor time that advice takes, about, where all machines take `machines` seconds: of few and
/// quick machines it does not need what it may have.
[[nodiscard]] inline double advice_seconds(double machines) {
  const double least = 1e-9 * static_cast<double>(least_advised * least_advice_work);
  return std::max(std::min(least, machines), machines / static_cast<double>(advice_part_of_sweep));
}

}  // namespace marti::studies::sweep
