// What the timing of a machine may leave out: the plan's items "contention" and "cache".
#pragma once

#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/replay/replay.h"
#include "studies/run/plan/plan.h"

namespace marti::studies::run {

/// Sets the options of the replay that keep what the user wants kept.
void keep(const KeptItems& kept, processors::replay::ReplayOptions& options);

/// Both items for this machine, decided from its configuration and the size of its database, before it runs.
[[nodiscard]] std::vector<PlanEntry> machine_plan(const KeptItems& kept,
                                                  const processors::machine::MachineConfig& machine,
                                                  const processors::program::WorkLog& log, bool observed);

}  // namespace marti::studies::run
