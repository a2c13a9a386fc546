// What takes energy in a timed frame, from its counters.
#pragma once

#include "processors/energy/energy.h"
#include "processors/replay/replay.h"

namespace marti::processors {

/// The counts of a result of `config` on `log`.
[[nodiscard]] EnergyCounts energy_counts(const WorkLog& log, const MachineConfig& config,
                                         const MachineResult& result);

}  // namespace marti::processors
