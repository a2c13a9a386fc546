// The host memory that simulating a machine takes.
#pragma once

#include <cstdint>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"

namespace marti::processors::replay {

/// The machine without the contexts that never get a packet of an image of this size, because the first
/// requests of all contexts are for more packets than there are. It has the same results, but for the
/// requests of these contexts. Where the tree is built, all contexts are kept.
[[nodiscard]] machine::MachineConfig without_idle_contexts(const machine::MachineConfig& config,
                                                           std::uint32_t width, std::uint32_t height);

/// Host bytes that a replay of an image of this size takes for the machine's nodes and their tags,
/// approximately.
[[nodiscard]] std::uint64_t host_bytes(const machine::MachineConfig& machine, std::uint32_t width,
                                       std::uint32_t height);

/// Host bytes of a replay of this frame: the above, and those for the order of packets, for what [count]
/// keeps of each line of memory, and for the state of trees that are built. Throws UserError for a database
/// too large for the machine.
[[nodiscard]] std::uint64_t host_bytes(const program::WorkLog& log, const machine::MachineConfig& config);

}  // namespace marti::processors::replay
