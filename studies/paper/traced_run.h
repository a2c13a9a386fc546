// A traced frame of the study, with what its tree holds and how often each level is visited.
#pragma once

#include <memory>
#include <vector>

#include "processors/program/work_log.h"
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
