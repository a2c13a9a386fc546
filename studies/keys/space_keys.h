// The configuration keys of the space scheme.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

void declare_space_keys(sim::Schema& schema);

/// Reads the scheme's keys if `machine` has the space scheme, and marks those without effect: with another
/// scheme these keys; with the space scheme the keys of shared memory and of the database's placement. Scheme
/// and nodes of `machine` must have been read. Throws UserError naming file, line and key.
void read_space(sim::Config& config, processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
