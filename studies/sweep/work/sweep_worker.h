// One worker of a sweep: takes tasks, does them, brings the results.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/memory_budget.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/work/log_cache.h"
#include "studies/sweep/work/memory_gate.h"
#include "studies/sweep/work/stripped_log_cache.h"
#include "studies/sweep/work/task_source.h"

namespace marti::studies::sweep {

/// What the workers of one process share.
struct SweepSite {
  /// Half of the memory is for work logs; stripped logs and machines that are being timed share the rest.
  SweepSite(const SweepPlan& sweep, const sim::MemoryBudget& budget)
      : plan(sweep),
        memory(budget),
        logs(budget.limit() / 2),
        strips(budget.limit() / 4),
        machines(budget.limit() - budget.limit() / 2 - budget.limit() / 4) {}

  /// The log of a frame, traced if it is not in memory.
  [[nodiscard]] std::shared_ptr<const FrameLog> log_of(std::size_t frame);

  /// Says that no machine is timed on that frame any more.
  void drop(std::size_t frame) { strips.drop(frame); }

  const SweepPlan& plan;
  sim::MemoryBudget memory;
  LogCache logs;
  StrippedLogCache strips;
  MemoryGate machines;
};

/// Runs `workers` workers, or as many as the system has threads for, until there is nothing to do; throws
/// what the first to fail threw. The error of a machine that cannot be timed names it. Each worker is a
/// thread and not a task of oneTBB, because they wait for each other, and oneTBB's own threads must be free
/// to trace and strip meanwhile.
void work_together(SweepSite& site, TaskSource& source, unsigned workers);

}  // namespace marti::studies::sweep
