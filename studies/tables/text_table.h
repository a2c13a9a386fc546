// Tables as aligned text for people.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// Lines of cells in columns as wide as their widest cell. The columns for which `left` is true begin to the
/// left, all others end to the right.
[[nodiscard]] std::string aligned(const std::vector<std::vector<std::string>>& lines,
                                  const std::vector<bool>& left);

/// The title, a line of column names, a line of units, and the rows; numbers to the right. Times in ps are
/// shown in seconds, bytes in KiB, fractions in percent; integers with thousands separators; a cell without
/// value as "-". Control characters of a text are shown as \xNN, so that a row is a line.
[[nodiscard]] std::string text_of(const Table& table);

/// One figure of `table` side by side: a row for each value of column `row`, a column for each value of
/// `across`, which must be plain names (tables/table.h, tables/wide_table.h).
[[nodiscard]] std::string side_by_side(const Table& table, std::string_view row, std::string_view across,
                                       std::string_view value, std::string_view title);

}  // namespace marti::studies::tables
