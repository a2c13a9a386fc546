// What a report shows, gathered from the directory of a run, a sweep or a study: the answer in sentences,
// charts, tables, images and where it all comes from. It knows no page: report_page.h makes one of it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies {

struct ReportChart {
  std::string name;   ///< lower-case letters, digits and '_'; unique in the report
  std::string title;  ///< one line
  std::string note;   ///< what to look at, in a sentence or two; may be empty
  /// Complete Vega-Lite specification; its rows are inlined under data.values. Texts are UTF-8.
  nlohmann::ordered_json spec;
  std::string csv;  ///< the same rows (RFC 4180)
  /// How the explorer makes the rows anew for another machine; null for a chart that always stays as it is.
  nlohmann::ordered_json live;
};

struct ReportTable {
  Table table;
  bool folded = true;  ///< shown on demand only
};

struct ReportImage {
  std::string name;   ///< of its file, without extension
  std::string title;  ///< for people
  std::string png;    ///< the file's bytes
};

struct ReportData {
  std::string kind;                 ///< "run", "sweep" or "study"
  std::string title;                ///< one line
  std::vector<std::string> answer;  ///< sentences, the most important first
  std::vector<ReportChart> charts;
  std::vector<ReportTable> tables;
  std::vector<ReportImage> images;
  std::string configuration;                                    ///< text as in a TOML file; may be empty
  std::string text;                                             ///< the study's own report; may be empty
  std::vector<std::pair<std::string, std::string>> provenance;  ///< what, value
  /// Rows and model of a sweep for the explorer, as docs/report.md describes them; null without.
  nlohmann::ordered_json explorer;
};

/// Reads the directory that `marti run -o`, `marti sweep -o` or `marti study ... -o` has written. The same
/// files give the same data. Throws UserError, naming the file and what to do, for any other directory, and
/// for what cannot be read, is damaged, of another version or too large for a page.
[[nodiscard]] ReportData read_report(const std::filesystem::path& directory);

}  // namespace marti::studies
