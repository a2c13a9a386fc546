// The configuration keys of a simulated machine.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

void declare_machine_keys(sim::Schema& schema);

/// Reads and checks the machine. Marks the keys that the chosen kinds do not use, with the reason.
/// Throws UserError naming file, line and key.
[[nodiscard]] processors::machine::MachineConfig read_machine(sim::Config& config);

/// Throws what processors::check refuses, a sim::KeyError, as a UserError with file (or --set option), line
/// and key.
void check_machine(const sim::Config& config, const processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
