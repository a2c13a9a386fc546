// Orders of the tree's node records in memory. In each, the records of a branch's children stay in a row:
// they are found by one pointer.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/topology.h"
#include "memory/layout.h"

namespace marti::processors::walk {

/// The rank of a node that has no record.
inline constexpr std::uint32_t no_record = 0xffffffffU;

/// Breadth-first, as nodes are numbered. `leaf_records`: whether leaves have records.
[[nodiscard]] std::vector<std::uint32_t> breadth_first_rank(const accel::Topology& topology,
                                                            bool leaf_records);

/// Depth-first: the subtrees below a branch's children follow child by child.
[[nodiscard]] std::vector<std::uint32_t> depth_first_rank(const accel::Topology& topology,
                                                          bool leaf_records = true);

/// By treelets of at most `most` records: breadth-first from a treelet's top as far as it is filled; each
/// branch whose children do not fit begins a treelet with them, and these follow depth-first. Children that
/// alone are too many make a treelet, too.
[[nodiscard]] std::vector<std::uint32_t> treelet_rank(const accel::Topology& topology, bool leaf_records,
                                                      std::uint32_t most);

/// The record number of each node by the layout; empty when it is the node number.
[[nodiscard]] std::vector<std::uint32_t> node_rank(const accel::Topology& topology, bool leaf_records,
                                                   const memory::LayoutConfig& layout);

}  // namespace marti::processors::walk
