// What the charts that follow the explorer are made of: the points' figures in columns.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/report/model/report_points.h"
#include "studies/report/model/sweep_answer.h"

namespace marti::studies::report {

/// Figures that the page shows of every point that has them, however many points there are.
[[nodiscard]] std::vector<std::string> first_figures();

/// See docs/internals/pages.md. `axis`: the one that charts run along at first; std::nullopt for a sweep of
/// one machine.
[[nodiscard]] nlohmann::ordered_json explorer_json(const ReportPoints& sweep, const Chosen& chosen,
                                                   std::optional<std::size_t> axis);

}  // namespace marti::studies::report
