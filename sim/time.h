// Simulated time: a signed 64-bit count of picoseconds (2^63 ps are 107 days). Additions are checked: an
// overflow is a UserError, because only the durations of the user's machine can cause it.
#pragma once

#include <cstdint>
#include <string>

#include "sim/error.h"

namespace marti::sim {

/// One tick is one picosecond.
using Ticks = std::int64_t;

/// A time added up over many that run at the same time, in ticks: 2^32 of them of 2^63 ticks are 2^95.
using Sum = __int128;

inline constexpr Ticks ticks_per_second = 1'000'000'000'000;

[[noreturn]] void fail_time_overflow();

/// a + b, or a UserError when the sum does not fit in 64 bits.
inline Ticks add_ticks(Ticks a, Ticks b) {
  Ticks sum = 0;
  if (__builtin_add_overflow(a, b, &sum)) [[unlikely]] {
    fail_time_overflow();
  }
  return sum;
}

/// a * b, or a UserError when the product does not fit in 64 bits.
inline Ticks multiply_ticks(Ticks a, std::int64_t b) {
  Ticks product = 0;
  if (__builtin_mul_overflow(a, b, &product)) [[unlikely]] {
    fail_time_overflow();
  }
  return product;
}

/// The sum as a time, or a UserError when it does not fit in 64 bits.
inline Ticks ticks_of(Sum sum) {
  const auto ticks = static_cast<Ticks>(sum);
  if (ticks != sum) [[unlikely]] {
    fail_time_overflow();
  }
  return ticks;
}

/// A component's clock. The frequency is rounded once to a period of whole ticks; every duration of the
/// component is then a whole number of periods.
class Clock {
 public:
  /// `hertz` from 1 to 1e12. The period is 1e12 / hertz rounded to the nearest tick, at least 1.
  static Clock from_hertz(double hertz);
  /// A clock with a given period in ticks, at least 1.
  static Clock from_period(Ticks period);

  [[nodiscard]] Ticks period() const { return period_; }
  [[nodiscard]] Ticks cycles(std::int64_t count) const { return multiply_ticks(period_, count); }

 private:
  explicit Clock(Ticks period) : period_(period) {}
  Ticks period_;
};

}  // namespace marti::sim
