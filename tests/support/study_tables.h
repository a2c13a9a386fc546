// Finds the tables of a study's output.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "studies/tables/study_files.h"

namespace marti::test {

/// The table of this name. Throws InternalError when the output has no such table.
inline const studies::tables::Table& table_of(const studies::tables::StudyOutput& output,
                                              std::string_view name) {
  const auto found = std::ranges::find(output.tables, name, &studies::tables::Table::name);
  if (found == output.tables.end()) {
    throw sim::InternalError("there is no table " + std::string(name));
  }
  return *found;
}

}  // namespace marti::test
