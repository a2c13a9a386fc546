// How many significant digits a page needs. Numbers are rounded (sim/rounded.h) before the page and the plots
// are made of them, so that both show equal digits.
#pragma once

namespace marti::studies::report {

inline constexpr int curve_digits = 5;   ///< of what is modelled
inline constexpr int figure_digits = 6;  ///< of figures of exact points
inline constexpr int place_digits = 9;   ///< of places on an axis

}  // namespace marti::studies::report
