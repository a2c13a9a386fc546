#include "accel/grid_match.h"

#include <algorithm>

namespace marti::accel {

namespace {

std::string print(const std::array<std::uint32_t, 3>& n) {
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

}  // namespace

GridOptions matched_to(const Octree& octree, GridMatch match, GridOptions options) {
  const std::uint32_t triangles = octree.triangles().size();
  if (match == GridMatch::density || triangles == 0) {
    return options;
  }
  if (match == GridMatch::octree_cells) {
    options.resolution.fill(std::uint32_t{1} << (octree.levels().size() - 1));
    return options;
  }
  options.resolution.fill(0);
  const auto nodes = static_cast<double>(octree.topology().nodes.size());
  options.density = std::min(nodes / triangles, 0x1p20);
  return options;
}

std::string describe_resolution(const Grid& grid) {
  std::string text = print(grid.resolution()) + " cells";
  if (grid.resolution() != grid.requested()) {
    text += ", lowered from " + print(grid.requested()) + " by the grid's limits";
  }
  return text;
}

}  // namespace marti::accel
