// Tables as aligned text for people.
#pragma once

#include <cstddef>
#include <string>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// Characters, not bytes: bytes of UTF-8 that continue a character do not count.
[[nodiscard]] std::size_t width_of(const std::string& text);

/// The title, a line of column names, a line of units, and the rows; numbers to the right. Times in ps are
/// shown in seconds, bytes in KiB, fractions in percent; integers with thousands separators; a cell without
/// value as "-". Control characters of a text are shown as \xNN, so that a row is a line.
[[nodiscard]] std::string text_of(const Table& table);

/// One figure of `table` side by side: a row for each value of column `row`, a column for each value of
/// `across`, which must be plain names (tables/table.h, tables/wide_table.h).
[[nodiscard]] std::string side_by_side(const Table& table, std::string_view row, std::string_view across,
                                       std::string_view value, std::string_view title);

}  // namespace marti::studies::tables
