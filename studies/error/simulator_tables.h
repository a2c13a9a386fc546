// What the study of the simulator's methods found, as tables.
#pragma once

#include <span>
#include <vector>

#include "studies/error/simulator_errors.h"
#include "studies/tables/table.h"

namespace marti::studies::error {

/// "error_methods": a row for each method, for people.
[[nodiscard]] tables::Table method_table(const SimulatorStudy& study, std::span<const MethodErrors> errors);
/// "error_figures": a row for each method and figure.
[[nodiscard]] tables::Table figure_table(const SimulatorStudy& study, std::span<const MethodErrors> errors);
/// "error_cases": a row for each method and machine.
[[nodiscard]] tables::Table case_table(const SimulatorStudy& study);
/// "error_levels": accesses to each level of each octree.
[[nodiscard]] tables::Table level_table(const SimulatorStudy& study);

// Measured on the host.

/// "host_error_time": a row for each method and figure: run time beside error, and the Pareto front.
[[nodiscard]] tables::Table time_table(const SimulatorStudy& study, std::span<const MethodErrors> errors);
/// "host_error_fastest": the fastest method for errors of 10, 3, 1, 0.3 and 0 %.
[[nodiscard]] tables::Table fastest_table(const SimulatorStudy& study, std::span<const MethodErrors> errors);
/// "error_measured": the figures that `marti run --within` rests on
/// (studies/estimate/measured_errors.h).
[[nodiscard]] tables::Table measured_table(const SimulatorStudy& study);

}  // namespace marti::studies::error
