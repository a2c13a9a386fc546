// The page of a comparison, and the parts that all comparisons share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/compare/differences.h"
#include "studies/compare/result_and_sweep.h"
#include "studies/compare/two_sweeps.h"
#include "studies/compare/verdict.h"
#include "studies/report/model/report_data.h"
#include "studies/report/page/sorted_table.h"

namespace marti::studies::compare {

/// A page shows so many points; its sentences say how many there are.
inline constexpr std::size_t most_page_points = 20'000;

/// Keys with both values and their meaning, in the order given.
[[nodiscard]] report::SortedTable settings_table(const std::string& title,
                                                 const std::vector<Difference>& settings);

/// Figures with both values as people write them, the change and the meaning.
[[nodiscard]] report::SortedTable figures_table(const std::string& title,
                                                const std::vector<Difference>& figures);

/// A figure's value; rows are sorted by the number itself.
[[nodiscard]] report::SortedCell figure_cell(const tables::Cell& value, const std::string& figure);
/// The change of a figure; rows are sorted by its size.
[[nodiscard]] report::SortedCell change_cell(const Difference& figure);
[[nodiscard]] report::SortedCell time_cell(std::int64_t ps);
[[nodiscard]] report::SortedCell ratio_cell(double ratio);
[[nodiscard]] report::SortedCell integer_cell(std::int64_t number);

/// A point on the chart of ratios.
struct RatioPoint {
  std::int64_t point = 0;
  std::string name;
  std::int64_t a = 0;  ///< frame times, ps
  std::int64_t b = 0;
};
[[nodiscard]] report::ReportChart ratio_chart(const std::vector<RatioPoint>& points);

/// "A is base, made by marti 0.1.0".
[[nodiscard]] std::string who_is(const char* letter, const std::string& name, const std::string& version);

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
