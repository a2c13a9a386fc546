// What `marti study error` has found, as tables and sentences.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "studies/error/setting.h"
#include "studies/tables/table.h"

namespace marti::studies::error {

/// A setting's processor time (the median) over that of the setting it is held against.
[[nodiscard]] double share_of(const std::vector<Setting>& settings, const Setting& setting);

/// Errors that a reader may allow.
inline constexpr std::array<double, 4> targets = {0.1, 0.03, 0.01, 0.003};

/// Index of the setting that takes the least processor time of those that are held against `exact` and whose
/// error is at most `target`, or of that itself. Errors below its noise count as the noise.
[[nodiscard]] std::size_t cheapest(const std::vector<Setting>& settings, std::size_t exact, double target);

/// The answer: which way gives which error for which share of the run time, a sentence for the frame time and
/// for each knob of the renderer.
[[nodiscard]] std::vector<std::string> answers_of(const std::vector<Setting>& settings);

/// "host_error": a row for each setting.
[[nodiscard]] tables::Table error_table(const std::vector<Setting>& settings);

}  // namespace marti::studies::error
