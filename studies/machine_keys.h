// The configuration keys of a simulated machine.
#pragma once

#include "processors/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies {

void declare_machine_keys(sim::Schema& schema);

/// Reads and checks the machine. Marks the keys that the chosen kinds do not use, with the reason.
/// Throws UserError naming file, line and key.
[[nodiscard]] processors::MachineConfig read_machine(sim::Config& config);

/// Throws the UserError of processors::check with file, line and key: its message begins with the key that it
/// is about, if it is about one.
void check_machine(const sim::Config& config, const processors::MachineConfig& machine);

}  // namespace marti::studies
