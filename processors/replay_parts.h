// What the replays of all schemes set up in the same way.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "memory/interconnect.h"
#include "memory/layout.h"
#include "processors/node_array.h"
#include "processors/replay.h"
#include "processors/tree_plan.h"
#include "sim/engine.h"

namespace marti::processors {

/// Where the database's records lie; places what is built during the frame behind them. Throws UserError for
/// a database too large for line numbers.
[[nodiscard]] memory::Layout layout_of(const WorkLog& log, const MachineConfig& config,
                                       std::optional<TreePlan>& plan);

/// The record number of each tree node; empty when that is its own number.
[[nodiscard]] std::vector<std::uint32_t> node_ranks(const WorkLog& log, const MachineConfig& config);

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
