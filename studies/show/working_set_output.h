// The misses of caches of other sizes and ways in the summary, in result.json and as a table, from one pass
// over a run's references.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "processors/passes/working_set.h"
#include "studies/tables/table.h"

namespace marti::studies::show {

/// The field machine.working_set, as docs/result-schema.md describes it.
[[nodiscard]] nlohmann::ordered_json working_set_json(const processors::passes::WorkingSet& set);

/// Lines of the summary.
[[nodiscard]] std::string working_set_lines(const processors::passes::WorkingSet& set);

/// The table "working_set": of each cache the fully associative sizes at which its misses change, thinned so
/// that neighbours differ by 1/256 of their size or more, with all powers of two; then all ways counted at
/// the machine's number of sets.
[[nodiscard]] tables::Table working_set_table(const processors::passes::WorkingSet& set);

}  // namespace marti::studies::show
