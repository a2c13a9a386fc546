// Orders of the tree's node records in memory.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/topology.h"

namespace marti::processors {

/// The record number of each node when records are laid out depth-first: a branch's children stay in a
/// row (they are found by one pointer), and the subtrees below them follow child by child.
[[nodiscard]] std::vector<std::uint32_t> depth_first_rank(const accel::Topology& topology);

}  // namespace marti::processors
