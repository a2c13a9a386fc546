// The charts of reports: specifications (studies/report/charts/*.vl.json, built into the program) with the
// rows of a table.
#pragma once

#include <span>
#include <string>

#include "studies/report/report_charts.h"
#include "studies/tables/chart.h"
#include "studies/tables/table.h"

namespace marti::studies {

/// All specifications, in alphabetical order.
[[nodiscard]] std::span<const ChartSpecification> report_chart_specifications();

/// The chart of that specification with the rows of `table`. Its name and title are the table's. Throws
/// InternalError when there is no such specification.
[[nodiscard]] ReportChart make_chart(std::string_view specification, const Table& table,
                                     const std::string& note = {});

}  // namespace marti::studies
