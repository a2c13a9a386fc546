// Where the records of the database lie in memory.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "memory/layout.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/walk/tree_plan.h"

namespace marti::processors::walk {

/// Number of nodes that have a record of their own in a tree that is given: of a bvh its branches, whose
/// records hold the boxes and places of their children, without instances.
[[nodiscard]] std::uint64_t node_records(const program::WorkLog& log);
/// Number of instances, each of which has a transform.
[[nodiscard]] std::uint64_t transform_records(const program::WorkLog& log);

/// The plan by which the tree is built, from the `starts` of its branches or, without any, from those that
/// the configuration gives (build_start.h); std::nullopt when the tree is given.
[[nodiscard]] std::optional<TreePlan> tree_plan_of(const program::WorkLog& log,
                                                   const machine::MachineConfig& config,
                                                   std::vector<BranchStart> starts = {});

/// Bytes of each record where the primitives of a leaf lie in a row (LeafLayout::inline_records): as long as
/// the longest kind of primitive that there is.
[[nodiscard]] std::uint32_t inline_record_bytes(const program::WorkLog& log,
                                                const memory::LayoutConfig& layout);

/// Where lanes of SIMT nodes keep the parts of their stacks that are not on chip (RtUnitConfig::stack):
/// behind the frame buffer of their cluster's memory. Each node's part begins on a line, each lane's on a
/// sector.
struct StackPlaces {
  memory::Address begin = 0;
  std::uint64_t lane_bytes = 0;
  std::uint64_t node_bytes = 0;

  /// `node`: its number in its cluster; `lane`: that of a lane among those of all of its warps.
  [[nodiscard]] memory::Address of(std::uint32_t node, std::uint64_t lane) const {
    return begin + node * node_bytes + lane * lane_bytes;
  }
};

/// For a layout that layout_of() has made for this machine, which has such stacks.
[[nodiscard]] StackPlaces stack_places(const program::WorkLog& log, const machine::MachineConfig& config,
                                       const memory::Layout& layout);

/// The layout of the database's records; sets `plan` to the places of what is built during the frame, behind
/// them. Throws UserError for a database too large for line numbers.
[[nodiscard]] memory::Layout layout_of(const program::WorkLog& log, const machine::MachineConfig& config,
                                       std::optional<TreePlan>& plan);

/// The number of lines of memory, or of words of a machine without caches, with what is built; `plan`: null
/// when the tree is given.
[[nodiscard]] std::uint64_t memory_lines(const machine::MachineConfig& config, const memory::Layout& layout,
                                         const TreePlan* plan);

/// The record number of each tree node, or no_record (node_order.h); empty when it is the node number.
[[nodiscard]] std::vector<std::uint32_t> node_ranks(const program::WorkLog& log,
                                                    const machine::MachineConfig& config);

}  // namespace marti::processors::walk
