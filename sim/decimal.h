// Sums of decimal figures in binary numbers, turned back into the decimal that they stand for.
#pragma once

#include <array>
#include <charconv>

namespace marti::sim {

/// The number nearest to the decimal that has `digits` significant digits (1 to 17) of `value`: 3.3 + 3.3
/// + 3.3 is 9.899999999999999 in binary numbers, with 14 digits 9.9. What is not finite stays.
[[nodiscard]] inline double with_digits(double value, int digits) {
  std::array<char, 32> text{};
  const auto written =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, digits - 1);
  double rounded = value;
  // Beyond the largest number, from_chars leaves `rounded` as it is.
  std::from_chars(text.data(), written.ptr, rounded);
  return rounded;
}

}  // namespace marti::sim
