// The state of the trees when the frame is over: levels, bytes, and the laws that they obey.
#pragma once

#include "processors/cost/accounting.h"
#include "processors/cost/build_mix.h"
#include "processors/node/build_result.h"
#include "processors/node/tree_copies.h"
#include "processors/walk/replay_input.h"

namespace marti::processors::node {

/// Levels and copies; the caller adds start-up time and the nodes' counts. `input.tree` must be set.
[[nodiscard]] BuildResult report_build(const walk::ReplayInput& input, const TreeCopies& copies);

/// Adds the compute cycles of `counts` to the node's time for building.
void add_building_time(const cost::BuildTicks& ticks, const BuildCounts& counts, cost::TimeDivision& time);

/// Throws InternalError unless the counts of the nodes agree with the trees that exist.
void check_build(const program::WorkLog& log, const machine::MachineConfig& config,
                 const BuildResult& result);

}  // namespace marti::processors::node
