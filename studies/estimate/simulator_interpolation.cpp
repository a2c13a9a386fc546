#include "studies/estimate/simulator_interpolation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/error.h"
#include "sim/mapped.h"

namespace marti::studies::estimate {

namespace {

// The slope at an inner point between pieces of lengths a and b and slopes p and q.
double inner_slope(double a, double b, double p, double q) {
  if (p * q <= 0.0) {
    return 0.0;
  }
  const double wide_a = 2.0 * b + a;
  const double wide_b = b + 2.0 * a;
  return (wide_a + wide_b) / (wide_a / p + wide_b / q);
}

// The slope at an end, next to pieces of lengths a, b and slopes p, q (C. Moler, "Numerical computing with
// MATLAB", 2004, section 3.4).
double end_slope(double a, double b, double p, double q) {
  const double slope = ((2.0 * a + b) * p - a * q) / (a + b);
  if (slope * p <= 0.0) {
    return 0.0;
  }
  return p * q <= 0.0 && std::abs(slope) > 3.0 * std::abs(p) ? 3.0 * p : slope;
}

}  // namespace

double interpolate(Curve curve, std::span<const double> xs, std::span<const double> ys, double x) {
  sim::ensure(xs.size() >= 2 && xs.size() == ys.size(), "a curve needs two points");
  const std::size_t pieces = xs.size() - 1;
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(xs, x) - xs.begin());
  const std::size_t piece = std::clamp<std::size_t>(above, 1, pieces) - 1;
  const auto length = [&](std::size_t i) { return xs[i + 1] - xs[i]; };
  const auto slope = [&](std::size_t i) { return (ys[i + 1] - ys[i]) / length(i); };
  if (x == xs[piece]) {
    return ys[piece];
  }
  if (x == xs[piece + 1]) {
    return ys[piece + 1];
  }
  if (curve == Curve::linear || pieces == 1 || x < xs.front() || x > xs.back()) {
    return ys[piece] + slope(piece) * (x - xs[piece]);
  }
  const auto slope_at = [&](std::size_t point) {
    if (point == 0) {
      return end_slope(length(0), length(1), slope(0), slope(1));
    }
    if (point == pieces) {
      return end_slope(length(pieces - 1), length(pieces - 2), slope(pieces - 1), slope(pieces - 2));
    }
    return inner_slope(length(point - 1), length(point), slope(point - 1), slope(point));
  };
  const double h = length(piece);
  const double t = (x - xs[piece]) / h;
  const double left = slope_at(piece);
  const double right = slope_at(piece + 1);
  return ys[piece] * (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t) + h * left * t * (1.0 - t) * (1.0 - t) +
         ys[piece + 1] * t * t * (3.0 - 2.0 * t) + h * right * t * t * (t - 1.0);
}

Estimate estimate_between(Curve curve, std::span<const double> xs, std::span<const MachineFigures> machines,
                          double x) {
  const std::vector<double> log_xs = sim::mapped(xs, [&](const double value) { return std::log(value); });
  Estimate estimate;
  for (std::size_t i = 0; i < figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    std::vector<double> ys =
        sim::mapped(machines, [&](const MachineFigures& machine) { return machine[figure]; });
    const auto known = std::ranges::find(xs, x);
    if (known != xs.end()) {
      estimate.value[figure] = ys[static_cast<std::size_t>(known - xs.begin())];
    } else if (std::ranges::all_of(ys, [](double y) { return y > 0.0; })) {
      std::ranges::transform(ys, ys.begin(), [](double y) { return std::log(y); });
      estimate.value[figure] = std::exp(interpolate(curve, log_xs, ys, std::log(x)));
    } else {
      estimate.value[figure] = interpolate(Curve::linear, log_xs, ys, std::log(x));
    }
  }
  return estimate;
}

}  // namespace marti::studies::estimate
