// Parts that the pages of several kinds of comparison have.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/compare/comparison_page.h"
#include "studies/compare/differences.h"

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

}  // namespace marti::studies::compare
