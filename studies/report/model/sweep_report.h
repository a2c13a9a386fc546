// The report of a sweep.
#pragma once

#include <optional>

#include "studies/report/model/report_data.h"
#include "studies/report/model/report_points.h"

namespace marti::studies::report {

/// `budget`: the price that a machine may have, if one is given.
[[nodiscard]] ReportData sweep_report(const ReportPoints& sweep, std::optional<double> budget = std::nullopt);

}  // namespace marti::studies::report
