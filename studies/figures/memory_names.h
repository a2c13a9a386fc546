// What the parts of the way to memory are called in sentences.
#pragma once

#include <string>

#include "processors/machine/machine_config.h"

namespace marti::studies::figures {

/// What connects the nodes to their memory: "ideal interconnect", "bus", "crossbar", or for a distributed
/// database "mesh network" and the like.
[[nodiscard]] std::string interconnect_name(const processors::machine::MachineConfig& machine);

/// What serves the memory's accesses one after another: "bank", or with DRAM "channel".
[[nodiscard]] std::string bank_name(const processors::machine::MachineConfig& machine);

}  // namespace marti::studies::figures
