// What making a frame's bounding volume hierarchy takes, in each way of `marti study frames`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "accel/bvh.h"
#include "accel/triangles.h"
#include "accel/two_level.h"
#include "processors/cost/tree_work.h"

namespace marti::studies::frames {

/// rebuild: built from nothing. rebuild_top, with kept instances: the top level is, and so are the trees of
/// meshes in which something moved. refit: the first frame's tree, its boxes fitted to what moved.
enum class RefitWay : std::uint8_t { rebuild, rebuild_top, refit };
inline constexpr std::size_t refit_ways = 3;
inline constexpr std::array<std::string_view, refit_ways> refit_way_names = {"rebuild", "rebuild_top",
                                                                             "refit"};

/// What has moved between two frames.
struct Moved {
  std::vector<bool> primitives;  ///< in the coordinates of their meshes
  std::vector<bool> instances;
  std::uint64_t count = 0;  ///< of primitives, in all instances
};
/// From nothing (null) to a first frame all has, and `count` is 0.
[[nodiscard]] Moved moved_between(const accel::TriangleSet* before, const accel::TriangleSet& after);

/// The machine's work to have the tree before the frame: records of all nodes are written; of those of the
/// top level and of meshes in which something has moved; or of those above what has moved.
[[nodiscard]] processors::cost::TreeWork work_of(const accel::Bvh& tree, const Moved& moved, RefitWay way);
[[nodiscard]] processors::cost::TreeWork work_of(const accel::TwoLevelBvh& tree, const Moved& moved,
                                                 RefitWay way);

}  // namespace marti::studies::frames
