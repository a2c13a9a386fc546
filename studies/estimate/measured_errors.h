// What `marti study error` has measured of samples, as part of the program.
//
// studies/estimate/measured_errors.csv is the table "error_measured" of a study; docs/error.md says how to
// make it anew.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "studies/estimate/simulator_figures.h"

namespace marti::studies::estimate {

/// Errors are measured apart for machines whose interconnect is busy up to these shares of the frame: how far
/// the contention in a sample is from that in the frame depends on it.
inline constexpr std::array<double, 3> load_classes = {0.3, 0.7, 1.0};
/// The class of an interconnect's use, a share from 0 on.
[[nodiscard]] std::size_t load_class_of(double use);
/// The fewest windows of a sample of a machine of each class: smaller ones were further off than their spread
/// says. They may miss the few places where most misses are. And where nodes wait for one another, the nodes
/// of two windows that follow one another in the sample, but not in the frame, meet at their border.
inline constexpr std::array<std::uint64_t, load_classes.size()> least_windows = {32, 32, 64};

/// The share of cases that a stated interval is to cover.
inline constexpr double stated_confidence = 0.95;

/// The measured errors of samples on machines of one class of load.
struct MeasuredError {
  double use_to = 1.0;       ///< the class's share
  std::size_t cases = 0;     ///< samples measured
  double covered = 0.0;      ///< share of them in intervals widened by what other scenes say, the least over
                             ///< all figures
  MachineFigures allowance;  ///< what a sample's own half-width is to be widened by, so that 95 % of errors
                             ///< are covered
};

/// The file as it was built into the program.
[[nodiscard]] std::string_view measured_errors_csv();

/// One for each of load_classes, in their order. Throws InternalError for any other table, or one of another
/// version of the methods.
[[nodiscard]] std::vector<MeasuredError> parse_measured_errors(std::string_view csv);

}  // namespace marti::studies::estimate
