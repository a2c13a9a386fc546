// The configuration keys of the second-level cache, and of what is counted about caches when asked.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

void declare_second_level_keys(sim::Schema& schema);

/// Reads the keys into `machine`, whose caches, database and interconnect are known, and marks those without
/// effect. Throws UserError naming file, line and key.
void read_second_level(sim::Config& config, processors::machine::MachineConfig& machine);

void declare_count_keys(sim::Schema& schema);

/// Reads into `machine`, which is otherwise complete, what it is asked to count. Throws UserError naming
/// file, line and key.
void read_count(sim::Config& config, processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
