// Estimates of machines between others that were timed exactly.
#pragma once

#include <cstdint>
#include <span>

#include "studies/estimate/simulator_figures.h"

namespace marti::studies::estimate {

/// linear: straight lines between the points. cubic: the monotone piecewise cubic of F. N. Fritsch and
/// R. E. Carlson (SIAM J. Numer. Anal. 17(2), 1980) with the slopes of F. N. Fritsch and J. Butland (SIAM J.
/// Sci. Stat. Comput. 5(2), 1984), which never leaves the range of the two points around.
enum class Curve : std::uint8_t { linear, cubic };

/// The value at `x` of the curve through the points (xs, ys). xs ascending, at least two; beyond them, the
/// last piece's line goes on. Throws InternalError for fewer points.
[[nodiscard]] double interpolate(Curve curve, std::span<const double> xs, std::span<const double> ys,
                                 double x);

/// All figures at size `x`, between machines of sizes `xs`, all positive. A figure whose values are all
/// positive is interpolated as log y over log x, any other by straight lines of y over log x.
[[nodiscard]] Estimate estimate_between(Curve curve, std::span<const double> xs,
                                        std::span<const MachineFigures> machines, double x);

}  // namespace marti::studies::estimate
