// Long tables turned wide, for people: one row a thing, one column a level.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// Rows of `table` that agree in all `keys` become one row; the values of column `spread` become columns
/// named `prefix` and the value; the cells are those of column `value`, without value where there is none.
/// Rows and columns come in the order in which they first appear. The values of `spread` must be integers or
/// texts that make plain names.
[[nodiscard]] Table widen(const Table& table, std::span<const std::string_view> keys, std::string_view spread,
                          std::string_view prefix, std::string_view value);

}  // namespace marti::studies::tables
