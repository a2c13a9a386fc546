// What `marti study error` has measured, as part of the program.
//
// studies/estimate/measured_errors.csv is the table "host_error_measured" of a study; docs/error.md says how
// to make it anew.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "studies/estimate/simulator_figures.h"

namespace marti::studies {

/// Allowances are measured apart for machines of up to 16, 64 and 256 nodes: contention differs.
inline constexpr std::array<std::uint32_t, 3> node_classes = {16, 64, 256};
/// The class of a number of nodes; std::nullopt beyond the last.
[[nodiscard]] std::optional<std::size_t> node_class_of(std::uint32_t nodes);

/// The share of cases that a stated interval is to cover.
inline constexpr double stated_confidence = 0.95;

/// The measured errors of one method on machines of one class of nodes (node_classes).
struct MeasuredError {
  std::size_t method = 0;  ///< index into simulator_methods()
  std::uint32_t nodes_to = 0;
  double share = 1.0;        ///< processor time over that of exact replay
  double covered = 0.0;      ///< share of cases in widened intervals, the least over all figures
  MachineFigures allowance;  ///< what the method's own half-width is to be widened by, so that 95 % of errors
                             ///< are covered
  MachineFigures own;        ///< the method's own half-width, as it was on average
};

/// The file as it was built into the program.
[[nodiscard]] std::string_view measured_errors_csv();

/// Throws InternalError for any other table, or one of another version of the methods.
[[nodiscard]] std::vector<MeasuredError> parse_measured_errors(std::string_view csv);

}  // namespace marti::studies
