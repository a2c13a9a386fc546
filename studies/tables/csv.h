// Tables as comma-separated values (RFC 4180).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// A header of column names, then a record for each row; lines end in CR LF. A text is quoted where the RFC
/// asks for it, and when it is empty, so that it differs from a cell without value, which is empty and bare.
/// A real is the shortest text that reads back as the same double, or nan, inf, -inf.
[[nodiscard]] std::string csv_of(const Table& table);

/// A list of objects as CSV, a row each. The columns are the names of all of them, in the order in which they
/// first occur; a row that lacks one, or has null there, has an empty cell.
[[nodiscard]] std::string csv_of_rows(const nlohmann::ordered_json& rows);

}  // namespace marti::studies::tables
