// Classes of misses, sharing of lines and attribution, which are counted on request, in the summary, in
// result.json and as a table of its own.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "processors/replay/replay.h"
#include "studies/run/run_result.h"
#include "studies/tables/table.h"

namespace marti::studies::show {

/// The field machine.counts, as docs/result-schema.md describes it.
[[nodiscard]] nlohmann::ordered_json counts_json(const processors::walk::CacheCountResult& counts);

/// Lines of the summary; empty when nothing was asked for.
[[nodiscard]] std::string counts_lines(const run::RunResult& result);

/// The table "attribution": a row for each cell that is not empty.
[[nodiscard]] tables::Table attribution_table(const std::vector<processors::walk::AttributionRow>& rows);

}  // namespace marti::studies::show
