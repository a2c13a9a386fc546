// What a report shows: the answer in sentences, charts, tables, images and where it all comes from.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies::report {

struct ReportChart {
  std::string name;   ///< lower-case letters, digits and '_'; unique in the report
  std::string title;  ///< one line
  std::string note;   ///< what to look at, in a sentence or two; may be empty
  /// Complete Vega-Lite specification; its rows are inlined under data.values. Texts are UTF-8.
  nlohmann::ordered_json spec;
  /// Of a chart that follows the explorer: how plots/explorer_rows.js makes the rows, which the specification
  /// lacks then. Else null.
  nlohmann::ordered_json live;
};

struct ReportTable {
  tables::Table table;
  bool folded = true;  ///< shown on demand only
};

struct ReportImage {
  std::string name;     ///< of its file, without extension
  std::string title;    ///< for people
  std::string png;      ///< the file's bytes
  std::string scale{};  ///< of a map in false colours: what the brightest stands for, 0 being the darkest
};

struct ReportData {
  std::string kind;                 ///< "run", "sweep" or "study"
  std::string title;                ///< one line
  std::string about;                ///< which machine and scene, in one line; may be empty
  std::vector<std::string> answer;  ///< sentences, the most important first
  std::vector<ReportChart> charts;
  std::vector<ReportTable> tables;
  std::vector<ReportImage> images;
  std::string configuration;                                    ///< text as in a TOML file; may be empty
  std::string text;                                             ///< the study's own report; may be empty
  std::vector<std::pair<std::string, std::string>> provenance;  ///< what, value
  /// Points and model of a sweep, of which the charts that follow the explorer are made, as
  /// docs/internals/pages.md describes them; null without.
  nlohmann::ordered_json explorer;
};

/// What a chart says below its title when it leaves the page.
[[nodiscard]] inline std::string chart_about(const ReportData& report) {
  return report.about.empty() ? report.title : report.title + "; " + report.about;
}

}  // namespace marti::studies::report
