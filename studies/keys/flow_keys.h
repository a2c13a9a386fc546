// The configuration keys of the schemes in which rays move from node to node: messages and the pipeline.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies {

void declare_flow_keys(sim::Schema& schema);

/// Reads what the machine's scheme uses of these keys and marks the others. `machine` has its scheme and its
/// nodes.
void read_flow(sim::Config& config, processors::MachineConfig& machine);

}  // namespace marti::studies
