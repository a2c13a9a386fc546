// Results as JSON for programs: tables, and how all of it is written.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// Indented by one space, with a line end. Text that is not UTF-8, which can only come from names in files,
/// has replacement characters; a number that is not finite is null.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);

/// The value; null for a cell without one and for what is not finite.
[[nodiscard]] nlohmann::ordered_json json_of(const Cell& cell);

/// The other way round. An integer beyond 64 bits with a sign becomes a real, and what is no number, text or
/// null its text as JSON.
[[nodiscard]] Cell cell_of(const nlohmann::ordered_json& value);

/// A list of the rows, an object each, with the columns' names; a value that is missing, NaN or infinite is
/// null.
[[nodiscard]] nlohmann::ordered_json rows_json(const Table& table);

/// {"name", "title", "columns": [{"name", "unit", "description"}], "rows": ...}.
[[nodiscard]] nlohmann::ordered_json table_json(const Table& table);

/// table_json() as json_text().
[[nodiscard]] std::string json_of(const Table& table);

}  // namespace marti::studies::tables
