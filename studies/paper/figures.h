// The paper's figures as tables: where the time goes, where the memory goes, where the accesses go.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "memory/layout.h"
#include "processors/cost/accounting.h"
#include "studies/paper/host_builds.h"
#include "studies/tables/table.h"

namespace marti::studies::paper {

/// The tasks of figure 1.
enum class Task : std::uint8_t { build, traversal, intersection, shading, memory, other };
inline constexpr std::size_t tasks = 6;
inline constexpr std::array<std::string_view, tasks> task_names = {"build",   "traversal", "intersection",
                                                                   "shading", "memory",    "other"};
using TaskTimes = std::array<sim::Ticks, tasks>;

/// The nodes' activities gathered by task: cache, interconnect and banks are memory; waiting for the host,
/// for locks and messages, and idling are other.
[[nodiscard]] TaskTimes tasks_of(const processors::cost::TimeSums& time);

/// "figure1": time by task. One row for each run and task; times[i] is of runs[i].
[[nodiscard]] tables::Table task_table(std::span<const TracedRun> runs, std::span<const TaskTimes> times);

/// "figure2": nodes and memory by level, for the whole tree and for the one that a frame leaves when nothing
/// but the root was built before it. One row for each run, tree and level.
[[nodiscard]] tables::Table memory_table(std::span<const TracedRun> runs, const memory::LayoutConfig& layout);

/// "figure3": node accesses by level. One row for each run and level.
[[nodiscard]] tables::Table access_table(std::span<const TracedRun> runs);

}  // namespace marti::studies::paper
