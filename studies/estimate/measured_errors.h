// What `marti study error` has measured of samples, as part of the program.
//
// studies/estimate/measured_errors.csv is the table "error_measured" of a study; docs/error.md says how to
// make it anew.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "studies/estimate/simulator_figures.h"

namespace marti::studies::estimate {

/// Errors are measured apart for machines whose interconnect is busy up to these shares of the frame: how far
/// the contention in a sample is from that in the frame depends on it. Most of all where the interconnect is
/// nearly full; where it is full it works all the time, in a sample as in the frame.
inline constexpr std::array<double, 4> load_classes = {0.3, 0.7, 0.95, 1.0};
/// The class of an interconnect's use, a share from 0 on.
[[nodiscard]] std::size_t load_class_of(double use);
/// And apart for samples of at least so many windows, up to the next size: small samples are further off than
/// their spread says. They may miss the few places where most misses are. And where nodes wait for one
/// another, the nodes of two windows that follow one another in the sample, but not in the frame, meet at
/// their border.
inline constexpr std::array<std::uint64_t, 2> sample_sizes = {32, 64};
/// Smaller samples are not used.
inline constexpr std::uint64_t least_windows = sample_sizes[0];
/// The last of sample_sizes that such a sample reaches; `windows` is at least least_windows.
[[nodiscard]] std::size_t size_class_of(std::uint64_t windows);

/// The share of cases that a stated interval is to cover.
inline constexpr double stated_confidence = 0.95;

/// The measured errors of samples of one class of size on machines of one class of load.
struct MeasuredError {
  double use_to = 1.0;        ///< the class's share
  std::uint64_t windows = 0;  ///< the class's fewest windows
  std::size_t cases = 0;      ///< samples measured
  double covered = 0.0;       ///< share of them in intervals widened by what other scenes say, the least over
                              ///< all figures
  MachineFigures allowance;   ///< what a sample's own half-width is to be widened by, so that 95 % of errors
                              ///< are covered
};

/// Of one class of load, in the order of sample_sizes.
using ErrorsBySize = std::array<MeasuredError, sample_sizes.size()>;
/// In the order of load_classes.
using MeasuredErrors = std::array<ErrorsBySize, load_classes.size()>;

/// The file as it was built into the program.
[[nodiscard]] std::string_view measured_errors_csv();

/// Throws InternalError for a table without a row for each class, in their order, or one of another version
/// of the methods.
[[nodiscard]] MeasuredErrors parse_measured_errors(std::string_view csv);

}  // namespace marti::studies::estimate
