// The grid's resolution by another structure's measure: the octree's.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "accel/grid.h"
#include "accel/octree.h"

namespace marti::accel {

enum class GridMatch : std::uint8_t {
  density,       ///< GridOptions as they are
  octree_nodes,  ///< about as many cells as the octree has nodes
  octree_cells,  ///< cells of the size of the octree's smallest: 2^(deepest level - 1) along each axis
};
inline constexpr std::array<std::string_view, 3> grid_match_names = {"density", "octree_nodes",
                                                                     "octree_cells"};

/// Options for a grid over the triangles of `octree`; the grid's limits still lower what they ask for.
[[nodiscard]] GridOptions matched_to(const Octree& octree, GridMatch match, GridOptions options);

/// One line: the resolution and, where the limits lowered it, what was asked for.
[[nodiscard]] std::string describe_resolution(const Grid& grid);

}  // namespace marti::accel
