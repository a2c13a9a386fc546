#include "accel/bsp.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "accel/build_memory.h"
#include "accel/primitive_overlap.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

constexpr std::uint32_t deepest_octree_level = 21;
// A node number must fit in a work log's operand.
constexpr std::size_t most_nodes = (std::size_t{1} << 28) - 8;

using Cell = std::array<std::uint32_t, 3>;

/// How many splits across an axis lead to the box of a node of `level`.
int halvings(unsigned axis, unsigned level) { return static_cast<int>((level - 1 + 2 - axis) / 3); }

/// A cell plane computed from its integer coordinate, so that neighbours get the same number.
double plane_at(const RootFrame& frame, unsigned axis, std::uint32_t i, int halved) {
  const int a = static_cast<int>(axis);
  return frame.box.lo[a] + (frame.box.hi[a] - frame.box.lo[a]) * std::ldexp(i, -halved);
}

/// The plane that splits each branch, by node number; 0 for leaves.
std::vector<double> splitting_planes(const RootFrame& frame, const Topology& topology) {
  std::vector<double> planes(topology.nodes.size(), 0.0);
  std::vector<Cell> cells(topology.nodes.size(), Cell{0, 0, 0});
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const TopologyNode& node = topology.nodes[n];
    if (node.leaf) {
      continue;
    }
    const unsigned axis = bsp_axis(node.level);
    for (std::uint32_t side = 0; side < 2; ++side) {
      Cell& child = cells[node.first + side];
      child = cells[n];
      child[axis] = 2 * child[axis] + side;
    }
    planes[n] = plane_at(frame, axis, 2 * cells[n][axis] + 1, halvings(axis, node.level + 1U));
  }
  return planes;
}

/// The centre and half size of a box between such planes, enlarged by delta for the overlap test.
struct Box {
  glm::dvec3 center;
  glm::dvec3 half;
};

/// Builds level by level. Nodes of a level are numbered in the order of their parents; `lists` holds the
/// triangles that each node lists.
class BspBuilder {
 public:
  BspBuilder(const TriangleSet& triangles, const BspOptions& options, const RootFrame& frame,
             Topology& topology, std::vector<LevelStatistics>& levels)
      : triangles_(triangles), options_(options), frame_(frame), topology_(topology), levels_(levels) {}

  void run() {
    Level level;
    level.cells.push_back({0, 0, 0});
    level.begin = {0, triangles_.size()};
    level.lists.resize(triangles_.size());
    for (std::uint32_t id = 0; id < triangles_.size(); ++id) {
      level.lists[id] = id;
    }
    add_node(1);
    while (!level.cells.empty()) {
      level = split_level(level);
    }
  }

 private:
  struct Level {
    std::uint8_t number = 1;
    std::uint32_t first_node = 0;
    std::vector<Cell> cells;
    std::vector<std::size_t> begin;  ///< first entry of each cell in lists, and the end
    std::vector<std::uint32_t> lists;
  };

  [[nodiscard]] Box box_of(const Cell& cell, unsigned level) const {
    Box box{};
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int halved = halvings(axis, level);
      const double lo = plane_at(frame_, axis, cell[axis], halved);
      const double hi = plane_at(frame_, axis, cell[axis] + 1, halved);
      box.center[static_cast<int>(axis)] = 0.5 * (lo + hi);
      box.half[static_cast<int>(axis)] = 0.5 * (hi - lo) + frame_.delta;
    }
    return box;
  }

  /// Whether the cells of the octree level that `level` belongs to are at least 8 delta thick. All three axes
  /// are tested together, so that the tree ends at the same cells as the octree.
  [[nodiscard]] bool resolvable(unsigned level) const {
    const int halved = halvings(0, level);
    for (int a = 0; a < 3; ++a) {
      const double thickness = std::ldexp(frame_.box.hi[a] - frame_.box.lo[a], -halved);
      if (!(thickness >= 8.0 * frame_.delta) || !(thickness > 0.0)) {
        return false;
      }
    }
    return true;
  }

  /// Whether all triangles of a node on an x level meet the same octants of it, two or more.
  [[nodiscard]] bool separates_nothing(const Level& level, std::size_t index) const {
    const Cell& cell = level.cells[index];
    std::array<Box, 8> octants;
    for (std::uint32_t o = 0; o < 8; ++o) {
      octants[o] = box_of({2 * cell[0] + (o & 1U), 2 * cell[1] + ((o >> 1U) & 1U), 2 * cell[2] + (o >> 2U)},
                          level.number + 3U);
    }
    std::uint32_t same = 0;
    for (std::size_t at = level.begin[index]; at < level.begin[index + 1]; ++at) {
      std::uint32_t met = 0;
      for (std::uint32_t o = 0; o < 8; ++o) {
        met |= overlaps(triangles_, level.lists[at], octants[o].center, octants[o].half) ? 1U << o : 0U;
      }
      if (at == level.begin[index]) {
        same = met;
      }
      if (met != same) {
        return false;
      }
    }
    return std::popcount(same) >= 2;
  }

  /// Sorts a node's list into the lists of its two halves, in `lists_of_children_`.
  void sort_into_children(const Level& level, std::size_t index) {
    const unsigned axis = bsp_axis(level.number);
    for (std::uint32_t side = 0; side < 2; ++side) {
      lists_of_children_[side].clear();
      Cell child = level.cells[index];
      child[axis] = 2 * child[axis] + side;
      const Box box = box_of(child, level.number + 1U);
      for (std::size_t at = level.begin[index]; at < level.begin[index + 1]; ++at) {
        const std::uint32_t id = level.lists[at];
        if (overlaps(triangles_, id, box.center, box.half)) {
          lists_of_children_[side].push_back(id);
        }
      }
    }
  }

  void add_node(std::uint8_t level) {
    topology_.nodes.push_back({0, 0, level, true});
    topology_.work.emplace_back();
  }

  /// Checks the memory for the level's nodes from `index` up to the next check.
  void require_memory(const Level& level, const Level& next, std::size_t index) const {
    const std::size_t end = std::min(index + nodes_between_checks, level.cells.size());
    const std::size_t children = 2 * (end - index);
    const std::size_t listed = level.begin[end] - level.begin[index];
    require_tree(options_.memory,
                 growing_bytes(topology_.nodes, children) + growing_bytes(topology_.work, children) +
                     growing_bytes(topology_.entries, listed) + growing_bytes(next.cells, children) +
                     growing_bytes(next.begin, children) + growing_bytes(next.lists, 2 * listed) +
                     bytes_of_vector(level.cells) + bytes_of_vector(level.begin) +
                     bytes_of_vector(level.lists) + 2 * listed * sizeof(std::uint32_t),
                 "bsp");
  }

  Level split_level(const Level& level) {
    Level next;
    next.number = static_cast<std::uint8_t>(level.number + 1);
    next.first_node = static_cast<std::uint32_t>(topology_.nodes.size());
    next.begin.push_back(0);
    LevelStatistics& statistics = levels_.emplace_back();
    const unsigned axis = bsp_axis(level.number);
    const bool may_split = level.number < 3 * (options_.max_level - 1) + 1 && resolvable(next.number);
    for (std::size_t index = 0; index < level.cells.size(); ++index) {
      if (index % nodes_between_checks == 0) {
        require_memory(level, next, index);
      }
      const std::size_t count = level.begin[index + 1] - level.begin[index];
      const std::size_t node = level.first_node + index;
      const std::uint64_t listed =
          topology_.entries.size() + next.lists.size() + (level.lists.size() - level.begin[index]);
      const bool split = may_split && count > options_.max_objects && listed < options_.max_entries &&
                         topology_.nodes.size() < most_nodes &&
                         !(axis == 0 && separates_nothing(level, index));
      topology_.work[node].listed = static_cast<std::uint32_t>(count);
      if (split) {
        options_.memory.end_if_stopped();
        topology_.work[node].overlaps = 2 * topology_.work[node].listed;
        sort_into_children(level, index);
        topology_.nodes[node] = {static_cast<std::uint32_t>(topology_.nodes.size()), 2, level.number, false};
        for (std::uint32_t side = 0; side < 2; ++side) {
          Cell child = level.cells[index];
          child[axis] = 2 * child[axis] + side;
          next.cells.push_back(child);
          next.lists.insert(next.lists.end(), lists_of_children_[side].begin(),
                            lists_of_children_[side].end());
          next.begin.push_back(next.lists.size());
          add_node(next.number);
        }
        ++statistics.branches;
        continue;
      }
      topology_.nodes[node] = {static_cast<std::uint32_t>(topology_.entries.size()),
                               static_cast<std::uint32_t>(count), level.number, true};
      topology_.entries.insert(topology_.entries.end(),
                               level.lists.begin() + static_cast<std::ptrdiff_t>(level.begin[index]),
                               level.lists.begin() + static_cast<std::ptrdiff_t>(level.begin[index + 1]));
      ++statistics.leaves;
      statistics.entries += count;
      statistics.empty_leaves += count == 0 ? 1U : 0U;
      statistics.overfull_leaves += count > options_.max_objects ? 1U : 0U;
    }
    return next;
  }

  const TriangleSet& triangles_;
  const BspOptions& options_;
  const RootFrame& frame_;
  Topology& topology_;
  std::vector<LevelStatistics>& levels_;
  std::array<std::vector<std::uint32_t>, 2> lists_of_children_;
};

}  // namespace

Bsp Bsp::build(std::shared_ptr<const TriangleSet> triangles, const BspOptions& options) {
  sim::ensure(triangles != nullptr, "a BSP tree needs a triangle set, even an empty one");
  require_range(kind_name, "max_objects", options.max_objects, 1, 0x7fffffffU);
  require_range(kind_name, "max_level", options.max_level, 1, deepest_octree_level);
  require_range(kind_name, "max_entries", options.max_entries, 1, std::uint64_t{1} << 30);
  Bsp tree;
  tree.triangles_ = std::move(triangles);
  tree.options_ = options;
  tree.frame_ = make_frame(*tree.triangles_);
  BspBuilder(*tree.triangles_, tree.options_, tree.frame_, tree.topology_, tree.levels_).run();
  if (options.walk == BspWalk::push_point && !tree.frame_.box.empty()) {
    require_tree(options.memory,
                 bytes_of(tree.topology_) + tree.topology_.nodes.size() * (sizeof(double) + sizeof(Cell)),
                 kind_name);
    tree.planes_ = splitting_planes(tree.frame_, tree.topology_);
    const auto deepest = static_cast<unsigned>(tree.levels_.size());
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      const double extent = tree.frame_.box.hi[a] - tree.frame_.box.lo[a];
      tree.push_[a] = std::ldexp(extent, -halvings(axis, deepest) - 1);
    }
  }
  return tree;
}

}  // namespace marti::accel
