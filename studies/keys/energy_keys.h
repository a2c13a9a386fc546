// The configuration keys of [energy]: what operations, accesses, bytes and time take of energy.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

void declare_energy_keys(sim::Schema& schema);

/// Sets the machine's energy: the preset's figures, with those that are given in their places. The rest of
/// the machine must have been read.
void read_energy(sim::Config& config, processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
