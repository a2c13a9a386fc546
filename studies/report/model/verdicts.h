// What verdicts in a table say, as sentences.
#pragma once

#include <string>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies::report {

/// Of a table "claims" (studies/tables/claim.h), or of one with the columns case, figure and verdict: how
/// many hold, then each that does not hold, or not everywhere.
[[nodiscard]] std::vector<std::string> verdict_sentences(const tables::Table& table);

}  // namespace marti::studies::report
