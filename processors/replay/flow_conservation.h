// The laws of the schemes in which rays move, in addition to those of every scheme.
#pragma once

#include "processors/replay/replay.h"

namespace marti::processors::replay {

/// Throws InternalError unless every camera ray was sent once, all rays made have ended, the nodes together
/// took exactly the steps of the log, every contribution was collected, and every message sent went through a
/// network.
void check_flow_conservation(const program::WorkLog& log, const machine::MachineConfig& config,
                             const MachineResult& result);

}  // namespace marti::processors::replay
