// Tables as JSON for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/results/table.h"

namespace marti::studies {

/// A list of the rows, an object each, with the columns' names; a value that is missing, NaN or infinite is
/// null.
[[nodiscard]] nlohmann::ordered_json rows_json(const Table& table);

/// {"name", "title", "columns": [{"name", "unit", "description"}], "rows": ...}, as text. Text that is not
/// UTF-8 has replacement characters.
[[nodiscard]] std::string json_of(const Table& table);

}  // namespace marti::studies
