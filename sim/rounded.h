// Numbers rounded to decimal digits: short ones for a page, and sums of decimal figures in binary numbers
// turned back into the decimal that they stand for.
#pragma once

#include <array>
#include <charconv>
#include <cmath>

namespace marti::sim {

/// To so many significant digits (1 to 17): 3.3 + 3.3 + 3.3 is 9.899999999999999 in binary numbers, with 14
/// digits 9.9. Infinities and NaN stay.
[[nodiscard]] inline double rounded(double value, int digits) {
  if (!std::isfinite(value)) {
    return value;
  }
  std::array<char, 32> text{};
  const auto written =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, digits - 1);
  // If the decimal is above the largest double, from_chars() does not change `result`.
  double result = value;
  std::from_chars(text.data(), written.ptr, result);
  return result;
}

}  // namespace marti::sim
