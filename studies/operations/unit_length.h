// What a walk costs per unit length of a ray, against what simple reasoning predicts.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/counted.h"

namespace marti::studies::operations {

/// One tree depth; lengths are in widths of the finest cell, of which there are `width` along each axis.
struct UnitLengthRow {
  std::uint32_t depth = 0;  ///< levels of the octree, the root being level 1
  std::uint32_t width = 0;  ///< 2^(depth - 1)
  double length = 0.0;      ///< of all rays inside the root box

  /// A grid of width^3 cells.
  std::uint64_t cells = 0;
  accel::OperationCounts grid;
  /// An octree whose leaves are all at `depth`.
  std::uint64_t full_branches = 0;
  std::uint64_t full_leaves = 0;
  accel::OperationCounts full;
  /// An octree that reaches `depth` along a sphere only.
  std::uint64_t surface_branches = 0;
  std::uint64_t surface_leaves = 0;
  accel::OperationCounts surface;
};

/// Walks of `rays` random rays, uniform in position and direction (isotropic), through the unit cube from
/// side to side, for depths 2 to `deepest` (at most 9). The structures list points, which are never hit, so
/// no ray ends early. Operations are those of the walk between its visits; tests and setting up are left out.
[[nodiscard]] std::vector<UnitLengthRow> measure_unit_lengths(std::uint32_t deepest, std::uint32_t rays);

}  // namespace marti::studies::operations
