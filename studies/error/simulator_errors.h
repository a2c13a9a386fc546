// What a study found about each method: errors, intervals that hold, and whether choices would be right.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "studies/error/simulator_study.h"
#include "studies/estimate/error_metrics.h"
#include "studies/estimate/measured_errors.h"

namespace marti::studies::error {

/// One figure by one method, over all cases that it has an answer for.
struct FigureErrors {
  estimate::ErrorSummary summary;  ///< worst_case is an index into SimulatorStudy::cases
  std::optional<double> covered;  ///< share of cases in the method's interval; std::nullopt if it states none
  /// That share with the interval widened by an allowance measured on the other scenes; std::nullopt with one
  /// scene.
  std::optional<double> covered_widened;
  /// What a half-width must be widened by, for each class, measured on all scenes: the conformal
  /// stated_confidence quantile of the amounts by which errors exceed the method's own half-widths.
  /// std::nullopt without cases.
  std::array<std::optional<double>, estimate::load_classes.size()> allowance;
};

struct MethodErrors {
  bool any = false;  ///< there is an answer to a case
  std::array<FigureErrors, estimate::figure_count> figures;
  double least_tau = 0.0;     ///< Kendall's, of frame times; the least of all frames
  double regret = 0.0;        ///< of choosing the shortest frame time; that of the worst frame
  double power_regret = 0.0;  ///< of choosing the most speed-up times efficiency; that of the worst frame
};

/// One for each of simulator_methods(). A machine that a method has no answer for keeps its exact time where
/// machines are ranked. Speed-up times efficiency is what D. L. Eager, J. Zahorjan and E. D. Lazowska choose
/// a number of nodes by ("Speedup versus efficiency in parallel systems", IEEE Trans. Computers 38(3), 1989).
[[nodiscard]] std::vector<MethodErrors> errors_of(const SimulatorStudy& study);

/// What `marti run --within` rests on: the errors of samples of all sizes that it takes. Classes that no
/// case is of are missing.
[[nodiscard]] std::vector<estimate::MeasuredError> measured_errors_of(const SimulatorStudy& study);

}  // namespace marti::studies::error
