// Rows of a chart as comma-separated values.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace marti::studies {

/// `rows` is a list of objects. The columns are the names of all of them, in the order in which they first
/// occur; a row that lacks one, or has null there, has an empty cell. RFC 4180, as csv_of() writes a Table.
[[nodiscard]] std::string csv_of_rows(const nlohmann::ordered_json& rows);

}  // namespace marti::studies
