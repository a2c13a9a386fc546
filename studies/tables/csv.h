// Tables as comma-separated values (RFC 4180).
#pragma once

#include <string>

#include "studies/tables/table.h"

namespace marti::studies {

/// A text as a cell: quoted where the RFC asks for it, and when it is empty.
[[nodiscard]] std::string csv_text(const std::string& text);

/// A header of column names, then a record for each row; lines end in CR LF. A text is quoted where the RFC
/// asks for it, and when it is empty, so that it differs from a cell without value, which is empty and bare.
/// A real is the shortest text that reads back as the same double, or nan, inf, -inf.
[[nodiscard]] std::string csv_of(const Table& table);

}  // namespace marti::studies
