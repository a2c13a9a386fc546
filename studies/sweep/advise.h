// What would help the machines of a sweep that matter most, measured by replays when all have been timed.
#pragma once

#include <cstddef>
#include <functional>

#include "sim/memory_budget.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/sweep/work/frame_log.h"

namespace marti::studies::sweep {

/// Measures as `marti run` does (studies/helps), on the frame with the shortest time of all, the fastest
/// machine, then the one at the knee of the front of price and time, then others of the front from the
/// fastest on. All together get a tenth of the work of the sweep's replays, so many machines that each has
/// enough for a good part of its steps: two at least, twelve at most. The work is counted, so the machines
/// and their steps are the same on every computer. Leaves out those that the store has advice for; calls
/// `save` with each other machine's index when it is measured. All machines of the plan must be timed.
/// `trace` gives the log of a frame; logs and replays share `memory`.
void advise(const SweepPlan& plan, SweepStore& store, const sim::MemoryBudget& memory,
            const std::function<FrameLog(std::size_t frame)>& trace,
            const std::function<void(std::size_t machine, const Advice&)>& save);

}  // namespace marti::studies::sweep
