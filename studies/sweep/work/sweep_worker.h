// One worker of a sweep: takes tasks, does them, brings the results.
#pragma once

#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/work/log_shelf.h"
#include "studies/sweep/work/memory_gate.h"
#include "studies/sweep/work/strip_shelf.h"
#include "studies/sweep/work/task_source.h"

namespace marti::studies {

/// What the workers of one process share.
struct SweepSite {
  const SweepPlan& plan;
  LogShelf& logs;
  StripShelf& strips;
  MemoryGate& machines;
};

/// Works until there is nothing to do. Throws any error; the error of a machine that cannot be timed names
/// it. Several may work at once, each in a thread of its own: threads and not tasks of oneTBB, because they
/// wait for each other, and oneTBB's own threads must be free to trace and strip meanwhile.
void work(const SweepSite& site, TaskSource& source);

/// Runs `workers` workers, or as many as the system has threads for, and returns when all have ended; throws
/// what the first to fail threw.
void work_together(const SweepSite& site, TaskSource& source, unsigned workers);

}  // namespace marti::studies
