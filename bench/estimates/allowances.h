// What intervals of samples must be widened by to hold, from samples beside exact answers.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "studies/estimate/machine_figures.h"

namespace marti::bench {

/// The error of an estimate: relative, or for `use` a difference. With a true value of 0: 0 when the estimate
/// is 0 too, else infinite.
[[nodiscard]] double error_of(studies::estimate::Figure figure, double estimate, double truth);

/// A value that a new one of the same distribution exceeds with a probability of at most 1 - confidence,
/// whatever the distribution is: the ceil(confidence (n + 1))-th smallest of n (split conformal prediction:
/// V. Vovk, A. Gammerman, G. Shafer, "Algorithmic learning in a random world", 2005). With too few values for
/// that, the largest. Throws InternalError for no values.
[[nodiscard]] double upper_quantile(std::vector<double> values, double confidence);

/// A sample beside the exact answer.
struct MeasuredSample {
  std::size_t scene = 0;
  bool one_node = false;                       ///< whose speed-up is 1, whatever a sample says
  std::size_t load = 0;                        ///< class of studies/estimate/measured_errors.h
  std::size_t size = 0;                        ///< class
  studies::estimate::MachineFigures error;     ///< error_of()
  studies::estimate::MachineFigures interval;  ///< half-widths; infinite ones hold everything and count not
};

/// The samples of one class of load and one of size.
struct Allowance {
  std::size_t cases = 0;  ///< of the figure that has most
  /// Share of the samples that lie in intervals widened by what the other scenes say, of the figure of which
  /// it is least; a scene alone covers none.
  double covered = 1.0;
  /// The conformal 95 % quantile of what errors exceed their interval by.
  studies::estimate::MachineFigures allowance;
};

/// std::nullopt where the class has no samples.
[[nodiscard]] std::optional<Allowance> allowance_of(std::span<const MeasuredSample> samples, std::size_t load,
                                                    std::size_t size);

}  // namespace marti::bench
