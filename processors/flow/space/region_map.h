// The regions of the space scheme: parts of the tree, each held by one node of a cluster.
//
// The tree is cut at a level. Each subtree whose root lies there is a region, and so is each leaf above,
// unless it is empty. The rest is the top, which every node holds: the branches above the level and the empty
// leaves down to it, which contain nothing that a single node would have to hold. Regions are numbered depth
// first, so regions with neighbouring numbers are usually neighbours in space.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "accel/topology.h"

namespace marti::processors::flow {

struct RegionMap {
  static constexpr std::uint32_t top = 0xffffffffU;

  std::vector<std::uint32_t> roots;      ///< tree node at the root of each region
  std::vector<std::uint32_t> region_of;  ///< for each tree node: its region, or `top`
  std::uint32_t top_nodes = 0;           ///< tree nodes that are in no region

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(roots.size()); }
};

/// Cuts the tree at `level`, at least 1; below the deepest leaf every leaf with objects is a region. Throws
/// InternalError unless every node but the first is a child of exactly one branch with a smaller number.
[[nodiscard]] RegionMap cut_regions(const accel::Topology& topology, std::uint32_t level);

/// The number of different primitives that the leaves of each part list. `part_of` has a part below `parts`
/// for each tree node, or RegionMap::top.
[[nodiscard]] std::vector<std::uint64_t> distinct_primitives(const accel::Topology& topology,
                                                             std::span<const std::uint32_t> part_of,
                                                             std::uint32_t parts, std::uint32_t primitives);

/// Calls visit(part, primitive) once for each different primitive of each part, part by part.
void each_distinct_primitive(const accel::Topology& topology, std::span<const std::uint32_t> part_of,
                             std::uint32_t parts, std::uint32_t primitives,
                             const std::function<void(std::uint32_t, std::uint32_t)>& visit);

}  // namespace marti::processors::flow
