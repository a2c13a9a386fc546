// The ways of walking a structure. Each has its own mix of operations, so a work log says which one made
// it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace marti::accel {

enum class Traversal : std::uint8_t {
  octree,          ///< octree_walk.h
  bsp_recursive,   ///< bsp.h
  bsp_push_point,  ///< bsp_push.h
  grid,            ///< grid.h
  none,            ///< brute_force.h
  bvh_two,         ///< bvh_walk.h, by the nodes of bvh_options.h
  bvh_four,
  bvh_six,
  bvh_eight,
  bvh_eight_quantised,
};
inline constexpr std::size_t traversals = 10;
inline constexpr std::array<std::string_view, traversals> traversal_names = {"octree",
                                                                             "bsp, recursive",
                                                                             "bsp, push-point",
                                                                             "grid",
                                                                             "none",
                                                                             "bvh, 2 children",
                                                                             "bvh, 4 children",
                                                                             "bvh, 6 children",
                                                                             "bvh, 8 children",
                                                                             "bvh, 8 quantised"};

/// Whether the structure is a bounding volume hierarchy. Then leaves have no records: that of their parent
/// says what they list.
[[nodiscard]] constexpr bool walks_bvh(Traversal traversal) { return traversal >= Traversal::bvh_two; }

}  // namespace marti::accel
