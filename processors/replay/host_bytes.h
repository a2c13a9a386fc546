// The host memory that simulating a machine takes.
#pragma once

#include <cstdint>

#include "processors/machine/machine_config.h"

namespace marti::processors::replay {

/// Host bytes that a replay of the machine takes for its nodes and their tags, approximately.
[[nodiscard]] std::uint64_t host_bytes(const machine::MachineConfig& config);

}  // namespace marti::processors::replay
