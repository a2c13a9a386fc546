// A grid's resolution that matches an octree.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "accel/grid.h"
#include "accel/octree.h"

namespace marti::accel {

enum class GridMatch : std::uint8_t {
  density,       ///< GridOptions unchanged
  octree_nodes,  ///< about as many cells as the octree has nodes
  octree_cells,  ///< cells of the size of the octree's smallest: 2^(deepest level - 1) along each axis
};
inline constexpr std::array<std::string_view, 3> grid_match_names = {"density", "octree_nodes",
                                                                     "octree_cells"};

/// Options for a grid over the triangles of `octree`; the grid's own limits may lower the resolution.
[[nodiscard]] GridOptions matched_to(const Octree& octree, GridMatch match, GridOptions options);

/// One line: the resolution, and the one asked for if the limits lowered it.
[[nodiscard]] std::string describe_resolution(const Grid& grid);

}  // namespace marti::accel
