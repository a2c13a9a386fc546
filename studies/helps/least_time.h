// How short a frame can be at most on a changed machine, without a replay.
#pragma once

#include "processors/replay/replay.h"

namespace marti::studies::helps {

/// A lower bound of the frame time of `changed`, which traces the frame that `machine` traced with `result`:
/// the steps of all rays take the same cycles on both, each step is some node's, and no node does two things
/// at a time. Time that depends on caches, memory, messages or building is left out.
[[nodiscard]] sim::Ticks least_time(const processors::machine::MachineConfig& machine,
                                    const processors::replay::MachineResult& result,
                                    const processors::machine::MachineConfig& changed);

}  // namespace marti::studies::helps
