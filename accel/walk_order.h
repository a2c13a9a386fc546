// Orders in which a ray takes the nodes of a bounding volume hierarchy that it has entered.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace marti::accel {

/// depth_first: the nearest child of the branch visited last, then what was entered last. breadth_first: what
/// was entered first. treelet_first: depth first among the nodes of the present treelet, then among all.
enum class WalkOrder : std::uint8_t { depth_first, breadth_first, treelet_first };
inline constexpr std::array<std::string_view, 3> walk_order_names = {"depth_first", "breadth_first",
                                                                     "treelet_first"};

}  // namespace marti::accel
