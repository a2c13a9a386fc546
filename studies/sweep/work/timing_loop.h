// The loop of a sweep: frame after frame, the machines on each in batches whose log is stripped in one pass.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sim/memory_budget.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/work/frame_log.h"
#include "studies/sweep/work/sweep_results.h"

namespace marti::studies::sweep {

/// What a loop has to do, as SweepStore::done() and frames_done() say it.
struct WorkDone {
  std::vector<bool> machines;
  std::vector<bool> frames;
};

/// A frame that was traced, and its log; null: none was.
struct TracedFrame {
  std::size_t number = 0;
  std::shared_ptr<const FrameLog> log;
};

/// Traces the frames and times the machines of the plan that are not done, `threads` of them at a time, and
/// hands each result to `results`; results do not depend on the number of threads. While the machines of one
/// batch are timed, the next batch is prepared: its log stripped and, where it begins another frame, that
/// frame traced, unless both logs together would take more than half of the memory. A quarter of the memory
/// is for stripped logs, a quarter for machines. Returns the last frame. Throws UserError; the error of a
/// machine that cannot be timed names it.
TracedFrame time_machines(const SweepPlan& plan, const WorkDone& done, const sim::MemoryBudget& memory,
                          unsigned threads, SweepResults& results);

}  // namespace marti::studies::sweep
