// The charts and tables of reports: files in studies/report/model/charts, built into the program. A chart is
// a Vega-Lite specification (*.vl.json); a table (*.table.json) describes its columns instead. Their
// "usermeta" says of which results they are, and what they show:
//
// - of: "run" or "sweep"; a file without it is filled by code
// - charts: a list of what follows, where one file draws several charts
// - order: of the charts of one page, and of its tables, ascending
// - name: lower-case letters, digits and '_'; by default the file's
// - title: one line
// - note: what to look at, in a sentence or two; may be left out
// - sql: the query that makes the rows, as a list of lines (result_tables.h); without rows the chart is left
// out
// - choice: a column of which the reader chooses one value from a list; an expression knows it as `choice`
// - live: of a sweep, instead of sql: how plots/explorer_rows.js makes the rows; its "fields" or "by" name
// the
//   figures that it needs, and without any of them the chart is left out
// - along: of a sweep: prefixes of keys; a chart for each axis that has one, instead of one for the reader's
// axis
// - words: of a sweep: words of the file and what stands in their place; PRICE is what machines are paid in
// - ideal: of a sweep: false if it has no line of the ideal speed-up
// - columns: of a table: name, type ("integer", "real" or "text"), unit and description of each
// - folded: of a table: whether it is shown on demand only
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "studies/report/model/report_data.h"
#include "studies/tables/chart.h"
#include "studies/tables/run_json.h"
#include "studies/tables/table.h"

namespace marti::studies::report {

/// All files, in alphabetical order.
[[nodiscard]] std::span<const tables::ChartSpecification> report_chart_specifications();

/// The chart of that specification with the rows of `table`. Its name and title are the table's. Throws
/// InternalError when there is no such specification.
[[nodiscard]] ReportChart make_chart(std::string_view specification, const tables::Table& table,
                                     const std::string& note = {});

/// Adds the charts and tables whose files are of a run. Throws as ResultTables does.
void add_queried(const tables::RunJson& run, ReportData& report);

/// A chart or a table as its file describes it.
struct DescribedChart {
  std::string_view file;  ///< without extension
  nlohmann::ordered_json meta;
};

/// The query of a description that has one.
[[nodiscard]] std::string query_of(const nlohmann::ordered_json& meta);

/// Those of such results, in their order.
[[nodiscard]] std::vector<DescribedChart> described_charts(std::string_view of);

/// Words of a specification, and what stands in their place.
using ChartWords = std::vector<std::pair<std::string, std::string>>;
[[nodiscard]] std::string replaced(std::string text, const ChartWords& words);

/// A chart whose rows the explorer makes by `live` (ReportChart::live).
[[nodiscard]] ReportChart live_chart(std::string_view specification, const std::string& name,
                                     const std::string& title, const nlohmann::ordered_json& live,
                                     const ChartWords& words = {});

/// A chart that a run or a study has written beside its results, with these rows.
[[nodiscard]] ReportChart chart_of_results(const tables::ChartSpecification& specification,
                                           const nlohmann::ordered_json& rows);

/// A name as charts, files and elements of the page have it: every other character than lower-case letters
/// and digits becomes '_'.
[[nodiscard]] std::string plain_name(std::string name);

}  // namespace marti::studies::report
