#include "studies/estimate/error_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/error.h"

namespace marti::studies::estimate {

namespace {

int sign_of(double difference) { return (difference > 0.0 ? 1 : 0) - (difference < 0.0 ? 1 : 0); }

}  // namespace

std::optional<double> kendall_tau(std::span<const double> a, std::span<const double> b) {
  sim::ensure(a.size() == b.size(), "ranks of lists of different lengths are compared");
  std::int64_t sum = 0;
  std::int64_t untied_a = 0;
  std::int64_t untied_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = i + 1; j < a.size(); ++j) {
      const int in_a = sign_of(a[i] - a[j]);
      const int in_b = sign_of(b[i] - b[j]);
      sum += in_a * in_b;
      untied_a += in_a != 0 ? 1 : 0;
      untied_b += in_b != 0 ? 1 : 0;
    }
  }
  if (untied_a == 0 || untied_b == 0) {
    return std::nullopt;
  }
  return static_cast<double>(sum) / std::sqrt(static_cast<double>(untied_a) * static_cast<double>(untied_b));
}

double regret(std::span<const double> truth, std::span<const double> estimate) {
  sim::ensure(!truth.empty() && truth.size() == estimate.size(), "a choice among no machines");
  const auto chosen = static_cast<std::size_t>(std::ranges::min_element(estimate) - estimate.begin());
  return truth[chosen] / *std::ranges::min_element(truth) - 1.0;
}

ErrorSummary summarise(std::span<const double> errors) {
  sim::ensure(!errors.empty(), "no errors to sum up");
  ErrorSummary summary;
  summary.cases = errors.size();
  for (std::size_t i = 0; i < errors.size(); ++i) {
    summary.mean += errors[i];
    summary.mean_abs += std::abs(errors[i]);
    if (std::abs(errors[i]) > std::abs(summary.worst)) {
      summary.worst = errors[i];
      summary.worst_case = i;
    }
  }
  summary.mean /= static_cast<double>(errors.size());
  summary.mean_abs /= static_cast<double>(errors.size());
  return summary;
}

double upper_quantile(std::vector<double> values, double confidence) {
  sim::ensure(!values.empty(), "a quantile of no values");
  std::ranges::sort(values);
  const auto rank = static_cast<std::size_t>(std::ceil(confidence * static_cast<double>(values.size() + 1)));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

double student_95(std::uint64_t degrees) {
  sim::ensure(degrees > 0, "Student's distribution has no 0 degrees of freedom");
  constexpr std::array table = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                                2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
                                2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
  if (degrees <= table.size()) {
    return table[degrees - 1];
  }
  // Cornish-Fisher expansion around the normal point (M. Abramowitz, I. A. Stegun, 1964, formula 26.7.5).
  constexpr double z = 1.959963984540054;
  const auto n = static_cast<double>(degrees);
  const double z3 = z * z * z;
  const double z5 = z3 * z * z;
  return z + (z3 + z) / (4.0 * n) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n);
}

MedianInterval median_interval(std::vector<double> values) {
  sim::ensure(!values.empty(), "a median of no values");
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return {median, values.front(), values.back(),
          1.0 - std::pow(2.0, 1.0 - static_cast<double>(values.size()))};
}

}  // namespace marti::studies::estimate
