// Tables among the lines of the summary.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace marti::studies::show {

/// The rows of a table: a name to the left, cells to the right of their columns.
struct TextColumns {
  int name = 0;             ///< width of the names, their indentation included
  std::vector<int> widths;  ///< of the other columns

  /// A row with its line break. A header is a row like any other.
  [[nodiscard]] std::string row(std::string_view name_of_row, const std::vector<std::string>& cells) const;
};

}  // namespace marti::studies::show
