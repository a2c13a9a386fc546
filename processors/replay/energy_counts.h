// What takes energy in a timed frame, from its counters.
#pragma once

#include "processors/energy/energy.h"
#include "processors/replay/driven_memory.h"
#include "processors/replay/replay.h"

namespace marti::processors::replay {

/// The counts of a result of `config` on `log`.
[[nodiscard]] energy::EnergyCounts energy_counts(const program::WorkLog& log,
                                                 const machine::MachineConfig& config,
                                                 const MachineResult& result);

/// The counts of a memory by itself, with the caches that its requests went through.
[[nodiscard]] energy::EnergyCounts energy_counts(const machine::MachineConfig& config,
                                                 const DrivenResult& driven);

}  // namespace marti::processors::replay
