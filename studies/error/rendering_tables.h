// The rendering family of `marti study error` as tables.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "studies/error/rendering.h"
#include "studies/estimate/error_metrics.h"
#include "studies/tables/table.h"

namespace marti::studies::error {

/// Relative errors that a user may allow.
inline constexpr std::array<double, 4> rendering_targets = {0.10, 0.03, 0.01, 0.003};

/// Indices into the study's points of a knob's settings that no other of the knob beats: neither in cost (a
/// figure for each point of the study) nor in error. Settings below the noise floor count with the floor.
[[nodiscard]] std::vector<std::size_t> front_of(const RenderingStudy& study, Knob knob,
                                                const std::vector<double>& costs);

/// Index of a knob's setting of least cost whose relative error is at most `target`, if there is one.
[[nodiscard]] std::optional<std::size_t> cheapest(const RenderingStudy& study, Knob knob, double target,
                                                  const std::vector<double>& costs);

/// For each point its counted steps, or the median of its run times in ms.
[[nodiscard]] std::vector<double> counted_costs(const RenderingStudy& study);
[[nodiscard]] std::vector<double> timed_costs(const RenderingStudy& study);

/// Relative error of a point as charts and fronts use it: at least that of the noise of its reference.
[[nodiscard]] double known_error(const RenderingStudy& study, const RenderingPoint& point);

/// The exponent b of RMSE ~ samples^b, by least squares of logarithms over all settings of several samples
/// above the noise floor; std::nullopt for fewer than two.
[[nodiscard]] std::optional<double> sample_exponent(const RenderingStudy& study);

/// "rendering_error": a row for each setting. The same input gives the same rows.
[[nodiscard]] tables::Table rendering_error_table(const RenderingStudy& study);
/// "rendering_cheapest": for each target and knob the setting of the fewest counted steps. Same input, same
/// rows.
[[nodiscard]] tables::Table rendering_cheapest_table(const RenderingStudy& study);
/// "host_rendering_time": a row for each setting, with its run time. Differs from run to run.
[[nodiscard]] tables::Table rendering_time_table(const RenderingStudy& study);
/// "host_rendering_fastest": for each target and knob the fastest setting. Differs from run to run.
[[nodiscard]] tables::Table rendering_fastest_table(const RenderingStudy& study);

}  // namespace marti::studies::error
