#include "studies/report/plots/plots.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/report/plots/child_process.h"
#include "studies/report/plots/vega_bundle.h"
#include "studies/tables/csv.h"
#include "studies/tables/result_directory.h"

namespace marti::studies::report {

// The text of studies/report/plots/draw.js, embedded by cmake/embed_text.cmake.
std::string_view draw_script();

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A chart takes some hundredths of a second.
constexpr std::chrono::seconds limit(120);

void check_names(const std::vector<ReportChart>& charts) {
  std::set<std::string_view> names;
  for (const ReportChart& chart : charts) {
    const bool plain = std::ranges::none_of(
        chart.name, [](char c) { return c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
    if (!plain || chart.name.empty() || chart.name.front() == '.' || chart.name.size() > 200) {
      throw sim::UserError("chart \"" + chart.name + "\": this cannot be the name of a file");
    }
    if (!names.insert(chart.name).second) {
      throw sim::UserError("chart \"" + chart.name + "\": there are two of this name, which would both be " +
                           chart.name + ".svg");
    }
  }
}

void refuse_results(const fs::path& directory) {
  for (const char* const file : {"result.json", tables::database_name}) {
    std::error_code ignored;
    if (fs::exists(directory / file, ignored)) {
      throw sim::UserError(directory.string() + " holds results (" + file +
                           "), which plots must not replace: give the plots a directory of their own");
    }
  }
}

/// The scripts as a page would load them, the charts, and what draws them: a program for node.
std::string drawing_program(const ReportData& report) {
  // Without these two the scripts take node for a browser, and define globals.
  std::string program = "var exports, module; exports = module = undefined;\n";
  for (const Script& script : vega_scripts()) {
    program += script.text;
    program += "\n";
  }
  program += report_chart_style_js().text;
  const Json charts = sim::mapped(report.charts, [&](const ReportChart& chart) {
    return Json{{"name", chart.name}, {"spec", chart.spec}, {"live", chart.live}};
  });
  // Passed as a text to be parsed: in an object literal "__proto__" would set the prototype.
  const std::string text =
      Json{{"charts", charts}, {"about", chart_about(report)}, {"explorer", report.explorer}}.dump(
          -1, ' ', true, Json::error_handler_t::replace);
  program += "const marti = {report: JSON.parse(" + Json(text).dump() + ")};\n";
  program += report_explorer_rows_js().text;
  program += report_explorer_specs_js().text;
  program += draw_script();
  return program;
}

Json draw(const ReportData& report) {
  const ChildProcess node{{"node", "-"}, "nodejs", {"TZ=UTC", "NODE_OPTIONS="}, limit};
  Json drawings = Json::parse(run_child(node, drawing_program(report)), nullptr, /*allow_exceptions=*/false);
  if (!drawings.is_array() || drawings.size() != report.charts.size()) {
    throw sim::UserError("node did not draw the charts: it gave something else");
  }
  return drawings;
}

std::string pdf_of(const std::string& svg) {
  // The date of the file would differ from time to time.
  const ChildProcess convert{
      {"rsvg-convert", "--format=pdf"}, "librsvg2-bin", {"SOURCE_DATE_EPOCH=0"}, limit};
  return run_child(convert, svg);
}

}  // namespace

std::vector<Plot> draw_plots(const ReportData& report, const fs::path& directory, bool pdf) {
  check_names(report.charts);
  refuse_results(directory);
  require_vega_scripts();
  const Json drawings = draw(report);
  std::vector<Plot> plots;
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const ReportChart& chart = report.charts[i];
    const auto svg = drawings[i]["svg"].get<std::string>();
    plots.push_back({chart.name + ".svg", svg});
    plots.push_back(
        {chart.name + ".csv",
         tables::csv_of_rows(chart.live.is_null() ? chart.spec["data"]["values"] : drawings[i]["rows"])});
    if (pdf) {
      plots.push_back({chart.name + ".pdf", pdf_of(svg)});
    }
  }
  return plots;
}

}  // namespace marti::studies::report
