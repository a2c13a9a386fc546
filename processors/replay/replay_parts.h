// What the replays of all schemes set up in the same way.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "memory/interconnect.h"
#include "memory/layout.h"
#include "processors/node/node_array.h"
#include "processors/replay/replay.h"
#include "sim/engine.h"

namespace marti::processors {

/// Each cluster's shared memory.
using Interconnects = std::vector<std::unique_ptr<memory::Interconnect>>;

/// Builds the memory systems of all clusters, whose own events are of `memory_class`, and connects the nodes
/// to them.
[[nodiscard]] Interconnects connect_memory(const MachineConfig& config, sim::Engine& engine,
                                           std::uint8_t memory_class, NodeArray& nodes);

/// What every scheme's result has: the nodes after NodeArray::finish(), the memory, the database.
[[nodiscard]] MachineResult common_result(const MachineConfig& config, const sim::Engine& engine,
                                          const NodeArray& nodes, const Interconnects& interconnects,
                                          const memory::Layout& layout);

}  // namespace marti::processors
