// Tables for papers.
#pragma once

#include <string>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// A tabular environment of LaTeX, without packages: a head of column names, a rule, a row each; texts to the
/// left, numbers to the right, reals with two decimals, a dash for a cell without value. The title is a
/// comment before it.
[[nodiscard]] std::string latex_of(const Table& table);

}  // namespace marti::studies::tables
