#include "bench/estimates/allowances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/error.h"

namespace marti::bench {

using studies::estimate::Figure;

namespace {

constexpr double stated_confidence = 0.95;

struct Excess {
  std::size_t scene = 0;
  double excess = 0.0;  // of the error over the interval; 0 inside it
};

std::vector<Excess> excesses_of(std::span<const MeasuredSample> samples, std::size_t load, std::size_t size,
                                Figure figure) {
  std::vector<Excess> excesses;
  for (const MeasuredSample& sample : samples) {
    const double interval = sample.interval[figure];
    if (sample.load == load && sample.size == size && std::isfinite(interval) &&
        !(figure == Figure::speed_up && sample.one_node)) {
      excesses.push_back({sample.scene, std::max(0.0, std::abs(sample.error[figure]) - interval)});
    }
  }
  return excesses;
}

// The quantile of all but those of scene `without`.
std::optional<double> quantile_of(std::span<const Excess> excesses, std::optional<std::size_t> without) {
  std::vector<double> values;
  for (const Excess& one : excesses) {
    if (one.scene != without) {
      values.push_back(one.excess);
    }
  }
  return values.empty() ? std::nullopt : std::optional(upper_quantile(std::move(values), stated_confidence));
}

double covered_of(std::span<const Excess> excesses) {
  std::size_t asked = 0;
  std::size_t covered = 0;
  for (const Excess& one : excesses) {
    if (const std::optional<double> allowance = quantile_of(excesses, one.scene)) {
      ++asked;
      covered += one.excess <= *allowance ? 1 : 0;
    }
  }
  return asked == 0 ? 0.0 : static_cast<double>(covered) / static_cast<double>(asked);
}

}  // namespace

double error_of(Figure figure, double estimate, double truth) {
  if (figure == Figure::use) {
    return estimate - truth;
  }
  if (truth == 0.0) {
    return estimate == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return estimate / truth - 1.0;
}

double upper_quantile(std::vector<double> values, double confidence) {
  sim::ensure(!values.empty(), "a quantile of no values");
  std::ranges::sort(values);
  const auto rank = static_cast<std::size_t>(std::ceil(confidence * static_cast<double>(values.size() + 1)));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

std::optional<Allowance> allowance_of(std::span<const MeasuredSample> samples, std::size_t load,
                                      std::size_t size) {
  Allowance found;
  for (std::size_t i = 0; i < studies::estimate::figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    const std::vector<Excess> excesses = excesses_of(samples, load, size, figure);
    if (const std::optional<double> allowance = quantile_of(excesses, std::nullopt)) {
      found.allowance[figure] = *allowance;
      found.covered = std::min(found.covered, covered_of(excesses));
      found.cases = std::max(found.cases, excesses.size());
    }
  }
  return found.cases > 0 ? std::optional(found) : std::nullopt;
}

}  // namespace marti::bench
