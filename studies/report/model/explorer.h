// What the charts that follow the explorer are made of: the points' figures in columns, and the model's
// curves.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>

#include "studies/report/model/report_points.h"
#include "studies/report/model/sweep_answer.h"
#include "studies/report/model/sweep_model.h"

namespace marti::studies::report {

/// What a chart over an axis of names says of itself.
inline constexpr const char* no_curve =
    "Bars are machines of the sweep, simulated exactly. Names have no order, so there is no curve.";

/// See docs/report.md. `axis`: the one that the curve runs along at first; std::nullopt for a sweep of one
/// machine.
[[nodiscard]] nlohmann::ordered_json explorer_json(const ReportPoints& sweep,
                                                   std::span<const AxisModel> models, const Chosen& chosen,
                                                   std::optional<std::size_t> axis);

}  // namespace marti::studies::report
