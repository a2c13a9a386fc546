// The paper's figures as tables: where the memory goes, where the accesses go.
#pragma once

#include <span>

#include "memory/layout.h"
#include "studies/paper/traced_run.h"
#include "studies/tables/table.h"

namespace marti::studies::paper {

/// "figure2": nodes and memory by level, for the whole tree and for the one that a frame leaves when nothing
/// but the root was built before it. One row for each run, tree and level.
[[nodiscard]] tables::Table memory_table(std::span<const TracedRun> runs, const memory::LayoutConfig& layout);

/// "figure3": node accesses by level. One row for each run and level.
[[nodiscard]] tables::Table access_table(std::span<const TracedRun> runs);

}  // namespace marti::studies::paper
