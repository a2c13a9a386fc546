// Numbers as short as a page needs them. They are rounded before the page and the plots are made of them, so
// that both show equal digits.
#pragma once

namespace marti::studies::report {

inline constexpr int curve_digits = 5;   ///< of what is modelled
inline constexpr int figure_digits = 6;  ///< of figures of exact points
inline constexpr int place_digits = 9;   ///< of places on an axis

/// To so many significant digits, which are at most 17; what is not finite stays as it is.
[[nodiscard]] double rounded(double value, int digits);

}  // namespace marti::studies::report
