// Orders of a tree's node records in memory. In each, the records of a branch's children stay in a row: they
// are found by one pointer.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/topology.h"

namespace marti::accel {

/// The rank of a node that has no record. An instance's rank is that of its transform among transforms, which
/// lie in the order in which node records of instances would.
inline constexpr std::uint32_t no_record = 0xffffffffU;

/// Breadth-first, as nodes are numbered. `leaf_records`: whether leaves have records.
[[nodiscard]] std::vector<std::uint32_t> breadth_first_rank(const Topology& topology, bool leaf_records);

/// Depth-first: the subtrees below a branch's children follow child by child.
[[nodiscard]] std::vector<std::uint32_t> depth_first_rank(const Topology& topology, bool leaf_records = true);

struct Treelets {
  std::vector<std::uint32_t> rank;     ///< the place of each node's record, or no_record
  std::vector<std::uint32_t> begin;    ///< the first rank of each treelet, plus the end; they are in a row
  std::vector<std::uint32_t> of_node;  ///< the treelet of each node's record; of others that of their parent
};

/// Cuts the tree into treelets of at most `most` records. A treelet is filled breadth-first from its first
/// records. Where the children of one of its branches do not fit, they begin a treelet of their own; treelets
/// follow each other depth-first. Children of one branch stay together, even if they are more than `most`.
[[nodiscard]] Treelets treelets_of(const Topology& topology, bool leaf_records, std::uint32_t most);

}  // namespace marti::accel
