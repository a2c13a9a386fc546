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
};
inline constexpr std::size_t traversals = 5;
inline constexpr std::array<std::string_view, traversals> traversal_names = {
    "octree", "bsp, recursive", "bsp, push-point", "grid", "none"};

}  // namespace marti::accel
