// Tables as aligned text for people.
#pragma once

#include <string>

#include "studies/results/table.h"

namespace marti::studies {

/// The title, a line of column names, a line of units, and the rows; numbers to the right. Times in ps are
/// shown in seconds, bytes in KiB, fractions in percent; integers with thousands separators; a cell without
/// value as "-". Control characters of a text are shown as \xNN, so that a row is a line.
[[nodiscard]] std::string text_of(const Table& table);

}  // namespace marti::studies
