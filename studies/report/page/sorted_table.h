// A table of a page, which its reader can sort by a click on a heading (sorting.js).
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace marti::studies::report {

struct SortedColumn {
  std::string name;
  bool number = false;      ///< to the right
  std::string description;  ///< shown over the heading; may be empty
};

/// What people read, and the number that rows are sorted by; without one they are sorted by the text.
struct SortedCell {
  std::string text;
  std::optional<double> number{};
};

struct SortedTable {
  std::string title;  ///< for screen readers; a heading is for the caller
  std::vector<SortedColumn> columns;
  std::vector<std::vector<SortedCell>> rows;  ///< each as long as `columns`
};

/// All texts are escaped.
[[nodiscard]] std::string sorted_table_html(const SortedTable& table);

}  // namespace marti::studies::report
