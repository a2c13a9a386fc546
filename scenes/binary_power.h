// Logarithms and powers to the base 2 from additions, multiplications and one division: with countable
// operations, and with the same bits on every host (the C library's functions differ between versions).
#pragma once

#include <bit>
#include <cstdint>

namespace marti::scenes {

/// 1 / ln 2.
inline constexpr double log_two_of_e = 1.4426950408889634;

/// The logarithm of a positive normal number: the series of artanh((m-1)/(m+1)) on the mantissa in
/// [sqrt(1/2), sqrt(2)) (Muller, Elementary Functions, 3rd ed., section 11.4).
template <typename Real>
Real log_two(const Real& number) {
  // The binary exponent is split off by integer operations on a register.
  const auto bits = std::bit_cast<std::uint64_t>(static_cast<double>(number));
  auto binary = static_cast<std::int64_t>(bits >> 52U) - 1023;
  auto mantissa =
      static_cast<Real>(std::bit_cast<double>((bits & 0x000fffffffffffffU) | 0x3ff0000000000000U));
  if (mantissa > Real(1.4142135623730951)) {
    mantissa = mantissa * Real(0.5);
    ++binary;
  }
  const Real s = (mantissa - Real(1.0)) / (mantissa + Real(1.0));
  const Real s2 = s * s;
  auto series = static_cast<Real>(1.0 / 19.0);
  for (int k = 17; k >= 1; k -= 2) {
    series = series * s2 + Real(1.0 / k);
  }
  return Real(static_cast<double>(binary)) + s * series * Real(2.8853900817779268);  // 2 / ln 2
}

/// 2 to an exponent of at most 0; 0 below 2^-1000. By the Taylor series of e^z for |z| <= ln(2)/2 (Muller,
/// section 11.2).
template <typename Real>
Real two_to(const Real& exponent) {
  if (exponent < Real(-1000.0)) {
    return Real(0.0);
  }
  const auto whole = static_cast<std::int64_t>(static_cast<double>(exponent) - 0.5);  // to nearest
  const Real z = (exponent - Real(static_cast<double>(whole))) * Real(0.69314718055994531);
  Real result(1.0);
  for (int k = 13; k >= 1; --k) {
    result = result * z * Real(1.0 / k) + Real(1.0);
  }
  const auto scale = static_cast<std::uint64_t>(whole + 1023) << 52U;
  return result * Real(std::bit_cast<double>(scale));
}

}  // namespace marti::scenes
