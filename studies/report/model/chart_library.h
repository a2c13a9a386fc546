// The charts of reports: specifications (studies/report/model/charts/*.vl.json, built into the program) with
// the rows of a table.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "studies/report/model/report_data.h"
#include "studies/tables/chart.h"
#include "studies/tables/table.h"

namespace marti::studies::report {

/// All specifications, in alphabetical order.
[[nodiscard]] std::span<const tables::ChartSpecification> report_chart_specifications();

/// The chart of that specification with the rows of `table`. Its name and title are the table's. Throws
/// InternalError when there is no such specification.
[[nodiscard]] ReportChart make_chart(std::string_view specification, const tables::Table& table,
                                     const std::string& note = {});

/// Words of a specification, and what stands in their place.
using ChartWords = std::initializer_list<std::pair<std::string_view, std::string_view>>;

/// A chart whose rows the explorer makes by `live` (ReportChart::live).
[[nodiscard]] ReportChart live_chart(std::string_view specification, const std::string& name,
                                     const std::string& title, const nlohmann::ordered_json& live,
                                     ChartWords words = {});

/// A chart that a run or a study has written beside its results, with these rows.
[[nodiscard]] ReportChart chart_of_results(const tables::ChartSpecification& specification,
                                           const nlohmann::ordered_json& rows);

/// A name as charts, files and elements of the page have it: every other character than lower-case letters
/// and digits becomes '_'.
[[nodiscard]] std::string plain_name(std::string name);

}  // namespace marti::studies::report
