// The host memory that simulating a machine takes.
#pragma once

#include <cstdint>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"

namespace marti::processors::replay {

/// Host bytes that a replay of the machine takes for its nodes and their tags, approximately.
[[nodiscard]] std::uint64_t host_bytes(const machine::MachineConfig& config);

/// Host bytes of a replay of this frame: the above, and those for the order of packets, for what [count]
/// keeps of each line of memory, and for the state of trees that are built. Throws UserError for a database
/// too large for the machine.
[[nodiscard]] std::uint64_t host_bytes(const program::WorkLog& log, const machine::MachineConfig& config);

}  // namespace marti::processors::replay
