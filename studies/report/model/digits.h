// How many significant digits a page needs. Numbers are rounded (sim/rounded.h) before the page and the plots
// are made of them, so that both show equal digits.
#pragma once

namespace marti::studies::report {

inline constexpr int figure_digits = 6;  ///< of figures of exact points

}  // namespace marti::studies::report
