// The configuration keys of the space scheme.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies {

void declare_space_keys(sim::Schema& schema);

/// Reads the scheme's keys when `machine` has it, and marks what it makes useless: itself with another
/// scheme, shared memory and where the database is with this one. `machine` has its scheme and its nodes.
/// Throws UserError naming file, line and key.
void read_space(sim::Config& config, processors::MachineConfig& machine);

}  // namespace marti::studies
