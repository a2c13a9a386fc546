// The keys of a shared memory that is one of DRAM.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

/// Declares memory.model, which belongs to the section before.
void declare_memory_model(sim::Schema& schema);
void declare_dram_keys(sim::Schema& schema);

/// Reads the memory behind an interconnect that has one.
void read_memory(sim::Config& config, processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
