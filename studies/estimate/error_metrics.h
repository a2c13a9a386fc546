// How far cheap answers are from the true ones, and whether they still lead to the right choice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace marti::studies::estimate {

/// Kendall's rank correlation tau-b of two lists of equal length (M. G. Kendall, "The treatment of ties in
/// ranking problems", Biometrika 33(3), 1945): 1 when both put all pairs in the same order, -1 when in the
/// opposite, and a pair tied in one list only counts half. std::nullopt when all values of a list are equal.
[[nodiscard]] std::optional<double> kendall_tau(std::span<const double> a, std::span<const double> b);

/// What it costs to choose by an estimate: the true value at the least estimate, over the least true value,
/// less 1. Of equal estimates the first is chosen. Values must be positive; throws InternalError without
/// values.
[[nodiscard]] double regret(std::span<const double> truth, std::span<const double> estimate);

/// Statistics of signed errors.
struct ErrorSummary {
  std::size_t cases = 0;
  double mean = 0.0;      ///< signed: the bias
  double mean_abs = 0.0;  ///< the size
  double worst = 0.0;     ///< signed, of the largest size
  std::size_t worst_case = 0;
};
/// Throws InternalError for no errors.
[[nodiscard]] ErrorSummary summarise(std::span<const double> errors);

/// A value that a new one of the same distribution exceeds with a probability of at most 1 - confidence,
/// whatever the distribution is: the ceil(confidence (n + 1))-th smallest of n (split conformal prediction:
/// V. Vovk, A. Gammerman, G. Shafer, "Algorithmic learning in a random world", 2005). With too few values for
/// that, the largest. Throws InternalError for no values.
[[nodiscard]] double upper_quantile(std::vector<double> values, double confidence);

/// The two-sided 95 % point of Student's distribution, from 1 degree of freedom on (12.706, 4.303, ...).
[[nodiscard]] double student_95(std::uint64_t degrees);

/// Median of an odd or even number of values, and the smallest and largest; the true median lies between
/// these with the confidence 1 - 2^(1 - n).
struct MedianInterval {
  double median = 0.0;
  double low = 0.0;
  double high = 0.0;
  double confidence = 0.0;
};
/// Throws InternalError for no values.
[[nodiscard]] MedianInterval median_interval(std::vector<double> values);

}  // namespace marti::studies::estimate
