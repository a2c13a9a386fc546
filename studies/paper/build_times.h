// The simulated machines behind tables 2 to 5.
#pragma once

#include <span>
#include <vector>

#include "studies/paper/building_table.h"
#include "studies/paper/traced_run.h"

namespace marti::studies::paper {

/// Times every initial level of every run on the configured machine, its tree shared by the nodes. Machines
/// are simulated at the same time on all host cores; the results do not depend on how many there are.
[[nodiscard]] std::vector<RunOutcomes> time_initial_levels(const PaperConfig& config,
                                                           std::span<const TracedRun> runs);

}  // namespace marti::studies::paper
