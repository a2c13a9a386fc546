// What building the trees takes on this computer, and frames traced with them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "processors/program/work_log.h"
#include "processors/replay/replay.h"
#include "studies/paper/building_table.h"
#include "studies/paper/level_counts.h"
#include "studies/paper/paper_keys.h"
#include "studies/tables/table.h"

namespace marti::studies::paper {

struct TracedRun {
  PaperRun run;
  processors::program::LogTotals totals;
  std::shared_ptr<const processors::program::WorkLog> log;
  std::vector<LevelCount> levels;  ///< of the whole tree
  NodeVisits visits;
};

/// Traces one run. Throws UserError as run_functional does.
[[nodiscard]] TracedRun trace_run(const PaperConfig& config, const PaperRun& run);

/// Times every initial level of every run on the configured machine, its tree shared by the nodes. Machines
/// are simulated at the same time on all host cores; the results do not depend on how many there are.
[[nodiscard]] std::vector<RunOutcomes> time_initial_levels(const PaperConfig& config,
                                                           std::span<const TracedRun> runs);

/// One initial level. Seconds are the least of the configured number of repetitions.
struct HostOutcome {
  InitialLevel initial;
  double build_seconds = 0.0;   ///< building to the initial level, on all host threads
  double render_seconds = 0.0;  ///< the frame, on all host threads
  std::uint64_t nodes = 0;      ///< what the frame leaves
  std::uint64_t partial = 0;
  std::uint64_t bytes = 0;  ///< host memory of nodes and lists
};

/// Builds and renders each initial level of a run. One after the other: they are timed.
[[nodiscard]] std::vector<HostOutcome> measure_host(const PaperConfig& config, const TracedRun& run);

/// "host_table2" for the first run, and so on.
[[nodiscard]] tables::Table host_building_table(std::size_t index, const PaperRun& run,
                                                std::span<const HostOutcome> outcomes);

}  // namespace marti::studies::paper
