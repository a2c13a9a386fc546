// The configuration keys of the schemes in which rays move from node to node: messages and the pipeline.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

void declare_flow_keys(sim::Schema& schema);

/// Reads the keys that the machine's scheme uses and marks the others as unused. Scheme and nodes of
/// `machine` must have been read.
void read_flow(sim::Config& config, processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
