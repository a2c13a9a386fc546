// What simulating a machine takes of the host's memory.
#pragma once

#include <cstdint>

#include "processors/machine/machine_config.h"

namespace marti::processors {

/// Host bytes that a replay of the machine takes for its nodes and their tags, roughly.
[[nodiscard]] std::uint64_t host_bytes(const MachineConfig& config);

}  // namespace marti::processors
