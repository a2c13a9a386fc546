// What is shown of a comparison: to people in a text or on a page, and to programs.
#pragma once

#include <string>
#include <vector>

#include "studies/compare/comparison.h"
#include "studies/report/model/report_data.h"
#include "studies/report/page/sorted_table.h"

namespace marti::studies::compare {

/// The last column of a table, which has no place in a text.
inline constexpr const char* page_column = "meaning";

/// A part below a heading: sentences, then charts (on the page only), then tables.
struct ComparisonPart {
  std::string id;     ///< of its element, a plain word
  std::string title;  ///< on the page
  std::string label;  ///< in the text, at most 14 characters
  std::vector<std::string> sentences;
  std::vector<report::ReportChart> charts{};
  std::vector<report::SortedTable> tables{};
  bool whole = false;  ///< the text shows all rows
};

struct ComparisonPage {
  std::string title;
  std::string a;  ///< names, as in Side
  std::string b;
  std::string about;                  ///< which program made them
  std::vector<ComparisonPart> parts;  ///< the verdict first
};

/// `all`: with the figures of two results that are equal.
[[nodiscard]] ComparisonPage page_of(const Comparison& found, bool all);

/// One object for programs. Settings have the values that their keys have: sizes in bytes, frequencies in Hz,
/// times in ps, shares, booleans and lists.
[[nodiscard]] std::string json_of(const Comparison& found, bool all);

}  // namespace marti::studies::compare
