// One scene of the study's tables 2 onwards, traced once; every machine is timed from its log.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "processors/program/work_log.h"
#include "processors/replay/replay.h"
#include "studies/paper/level_counts.h"
#include "studies/paper/paper_keys.h"

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

}  // namespace marti::studies::paper
