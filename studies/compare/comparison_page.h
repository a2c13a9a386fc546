// What the page of a comparison shows, as values. The same comparison gives the same page.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/compare/result_and_sweep.h"
#include "studies/compare/two_sweeps.h"
#include "studies/compare/verdict.h"
#include "studies/report/model/report_data.h"
#include "studies/report/page/sorted_table.h"

namespace marti::studies::compare {

/// A part of the page below a heading: sentences, then charts, then tables.
struct ComparisonPart {
  std::string id;     ///< of its element, a plain word
  std::string title;  ///< for people
  std::vector<std::string> sentences;
  std::vector<report::ReportChart> charts;
  std::vector<report::SortedTable> tables;
};

struct ComparisonPage {
  std::string title;
  std::vector<ComparisonPart> parts;  ///< the verdict first
};

[[nodiscard]] ComparisonPage page_of(const ComparedPair& pair);
[[nodiscard]] ComparisonPage page_of(const ResultAndSweep& found);
[[nodiscard]] ComparisonPage page_of(const TwoSweeps& found);

/// The HTML. UserError when the program was built without the scripts that draw charts.
[[nodiscard]] std::string html_of(const ComparisonPage& page);

}  // namespace marti::studies::compare
