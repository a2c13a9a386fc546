// The common set-up of the replays of all schemes.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "memory/interconnect.h"
#include "memory/layout.h"
#include "processors/node/node_array.h"
#include "processors/replay/replay.h"
#include "sim/engine.h"

namespace marti::processors::replay {

/// The packets of a frame in the order in which they are handed out, by ReplayOptions::packet_seed.
[[nodiscard]] machine::PacketList packets_of(const program::WorkLog& log,
                                             const machine::MachineConfig& config, std::uint64_t packet_seed);

/// Each cluster's shared memory.
using Interconnects = std::vector<std::unique_ptr<memory::Interconnect>>;

/// Builds the memory systems of all clusters and connects the nodes to them. `memory_class` is the class of
/// the memory systems' own events. `path`: null, or what watches the memory systems. `observer`: null, or who
/// may hear their requests; not with `path`.
[[nodiscard]] Interconnects connect_memory(const machine::MachineConfig& config, sim::Engine& engine,
                                           std::uint8_t memory_class, node::NodeArray& nodes,
                                           path::PathRecorder* path, walk::Observer* observer);

/// Adds a cluster to the result: what its memory has counted in a frame that ends at `end`.
void add_cluster(const memory::Interconnect& memory, sim::Ticks end, MachineResult& result);

/// The part of the result that all schemes have: nodes, memory, database. Of a frame that ends at `end`,
/// after NodeArray::finish(), or of what it has counted until then.
[[nodiscard]] MachineResult common_result(const machine::MachineConfig& config, const sim::Engine& engine,
                                          const node::NodeArray& nodes, const Interconnects& interconnects,
                                          const memory::Layout& layout, sim::Ticks end);

}  // namespace marti::processors::replay
