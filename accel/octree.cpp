#include "accel/octree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "accel/box_overlap.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

constexpr std::uint32_t deepest_level = 21;
// With no more entries than this, copies of the leaves' triangles (80 bytes an entry) are worth their memory.
constexpr std::uint64_t packed_entries_per_triangle = 16;
// A node number must fit in a work log's operand.
constexpr std::size_t most_nodes = (std::size_t{1} << 28) - 8;
constexpr std::uint64_t packed_entries_always = std::uint64_t{1} << 16;

using Cell = std::array<std::uint32_t, 3>;

/// Builds level by level. Nodes of a level are numbered in the order of their parents; `lists` holds what
/// each of them lists.
class Builder {
 public:
  Builder(const TriangleSet& triangles, const OctreeOptions& options, const RootFrame& frame,
          Topology& topology, std::vector<LevelStatistics>& levels)
      : triangles_(triangles), options_(options), frame_(frame), topology_(topology), levels_(levels) {}

  void run() {
    Level level;
    level.number = 1;
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
    std::vector<std::size_t> begin;  ///< into lists, one more than cells
    std::vector<std::uint32_t> lists;
  };

  /// A cell plane from its integer coordinate, so that neighbours share the same number.
  [[nodiscard]] double plane(int axis, std::uint32_t i, unsigned level) const {
    return frame_.box.lo[axis] +
           (frame_.box.hi[axis] - frame_.box.lo[axis]) * std::ldexp(i, -static_cast<int>(level - 1));
  }

  /// Whether cells of `level` are thick enough to be told apart.
  [[nodiscard]] bool resolvable(unsigned level) const {
    for (int a = 0; a < 3; ++a) {
      const double thickness = std::ldexp(frame_.box.hi[a] - frame_.box.lo[a], -static_cast<int>(level - 1));
      if (!(thickness >= 8.0 * frame_.delta) || !(thickness > 0.0)) {
        return false;
      }
    }
    return true;
  }

  /// The lists of the eight children of one node, one after the other, into `lists_of_children_`.
  void sort_into_children(const Level& level, std::size_t index) {
    overlaps_run_ = 0;
    for (auto& list : lists_of_children_) {
      list.clear();
    }
    const Cell& cell = level.cells[index];
    const unsigned below = level.number + 1U;
    std::array<std::array<double, 3>, 3> planes{};  // planes[which][axis]: low, middle, high
    for (int a = 0; a < 3; ++a) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        planes[k][static_cast<std::size_t>(a)] = plane(a, 2 * cell[static_cast<std::size_t>(a)] + k, below);
      }
    }
    std::array<std::array<double, 3>, 2> center{};
    std::array<std::array<double, 3>, 2> half{};
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t a = 0; a < 3; ++a) {
        center[side][a] = 0.5 * (planes[side][a] + planes[side + 1][a]);
        half[side][a] = 0.5 * (planes[side + 1][a] - planes[side][a]) + frame_.delta;
      }
    }
    for (std::size_t at = level.begin[index]; at < level.begin[index + 1]; ++at) {
      const std::uint32_t id = level.lists[at];
      const TriangleCorners& t = triangles_[id];
      // Children its bounding box meets; lanes 0 and 1 of `sides`: the lower and the upper half of an axis.
      std::uint32_t candidates = 0xffU;
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const double lo = std::min({t[a], t[3 + a], t[6 + a]});
        const double hi = std::max({t[a], t[3 + a], t[6 + a]});
        if (lo - frame_.delta > planes[1][a]) {
          candidates &= upper_half[a];
        } else if (hi + frame_.delta < planes[1][a]) {
          candidates &= ~upper_half[a];
        }
        inside = inside && lo >= planes[0][a] && hi <= planes[2][a];
      }
      if (inside && std::has_single_bit(candidates)) {
        lists_of_children_[static_cast<std::size_t>(std::countr_zero(candidates))].push_back(id);
        continue;
      }
      overlaps_run_ += static_cast<std::uint32_t>(std::popcount(candidates));
      for (; candidates != 0; candidates &= candidates - 1) {
        const auto child = static_cast<std::size_t>(std::countr_zero(candidates));
        const std::size_t x = child & 1U;
        const std::size_t y = (child >> 1U) & 1U;
        const std::size_t z = child >> 2U;
        if (overlaps(t, {center[x][0], center[y][1], center[z][2]}, {half[x][0], half[y][1], half[z][2]})) {
          lists_of_children_[child].push_back(id);
        }
      }
    }
  }

  /// Whether the lists just sorted only repeat the parent's: two or more children list everything and the
  /// others nothing.
  [[nodiscard]] bool separates_nothing(std::size_t parent_count) const {
    std::size_t complete = 0;
    for (const auto& list : lists_of_children_) {
      if (list.size() == parent_count) {
        ++complete;
      } else if (!list.empty()) {
        return false;
      }
    }
    return complete >= 2;
  }

  void add_node(std::uint8_t level) {
    topology_.nodes.push_back({0, 0, level, true});
    topology_.work.emplace_back();
  }

  Level split_level(const Level& level) {
    Level next;
    next.number = static_cast<std::uint8_t>(level.number + 1);
    next.first_node = static_cast<std::uint32_t>(topology_.nodes.size());
    next.begin.push_back(0);
    LevelStatistics& statistics = levels_.emplace_back();
    const bool may_split = level.number < options_.max_level && resolvable(next.number);
    for (std::size_t index = 0; index < level.cells.size(); ++index) {
      const std::size_t count = level.begin[index + 1] - level.begin[index];
      const std::size_t node = level.first_node + index;
      const std::uint64_t listed =
          topology_.entries.size() + next.lists.size() + (level.lists.size() - level.begin[index]);
      bool split = may_split && count > options_.max_objects && listed < options_.max_entries &&
                   topology_.nodes.size() < most_nodes;
      if (split) {
        sort_into_children(level, index);
        split = !separates_nothing(count);
      }
      topology_.work[node].listed = static_cast<std::uint32_t>(count);
      if (split) {
        topology_.work[node].overlaps = overlaps_run_;
        topology_.nodes[node] = {static_cast<std::uint32_t>(topology_.nodes.size()), 8, level.number, false};
        for (std::uint32_t child = 0; child < 8; ++child) {
          const Cell& c = level.cells[index];
          next.cells.push_back(
              {2 * c[0] + (child & 1U), 2 * c[1] + ((child >> 1U) & 1U), 2 * c[2] + (child >> 2U)});
          next.lists.insert(next.lists.end(), lists_of_children_[child].begin(),
                            lists_of_children_[child].end());
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

  static constexpr std::array<std::uint32_t, 3> upper_half{0xaaU, 0xccU, 0xf0U};

  const TriangleSet& triangles_;
  const OctreeOptions& options_;
  const RootFrame& frame_;
  Topology& topology_;
  std::vector<LevelStatistics>& levels_;
  std::array<std::vector<std::uint32_t>, 8> lists_of_children_;
  std::uint32_t overlaps_run_ = 0;
};

}  // namespace

Octree Octree::build(std::shared_ptr<const TriangleSet> triangles, const OctreeOptions& options) {
  sim::ensure(triangles != nullptr, "an octree needs a triangle set, even an empty one");
  require_range(kind_name, "max_objects", options.max_objects, 1, 0x7fffffffU);
  require_range(kind_name, "max_level", options.max_level, 1, deepest_level);
  require_range(kind_name, "max_entries", options.max_entries, 1, std::uint64_t{1} << 30);
  Octree tree;
  tree.triangles_ = std::move(triangles);
  tree.options_ = options;
  tree.frame_ = make_frame(*tree.triangles_);
  Builder(*tree.triangles_, tree.options_, tree.frame_, tree.topology_, tree.levels_).run();
  tree.pack();
  return tree;
}

#ifdef MARTI_ACCEL_AVX2
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

void Octree::pack() {
  nodes_.resize(node_offset + topology_.nodes.size());
  for (std::size_t n = topology_.nodes.size(); n-- > 0;) {
    const TopologyNode& node = topology_.nodes[n];
    OctreeNode& record = nodes_[node_offset + n];
    record.first = node.first;
    if (node.leaf) {
      record.info = node.count | OctreeNode::leaf_bit;
      continue;
    }
    record.info = 0;
    for (std::uint32_t child = 0; child < 8; ++child) {
      if (nodes_[node_offset + node.first + child].info != OctreeNode::leaf_bit) {
        record.info |= 1U << child;
      }
    }
  }
#ifdef MARTI_ACCEL_AVX2
  if (!has_avx2()) {
    return;
  }
#else
  return;
#endif
  if (topology_.entries.size() > packed_entries_always &&
      topology_.entries.size() > packed_entries_per_triangle * triangles_->size()) {
    return;
  }
  packed_nodes_ = nodes_;
  for (std::size_t n = 0; n < topology_.nodes.size(); ++n) {
    const TopologyNode& node = topology_.nodes[n];
    if (!node.leaf) {
      continue;
    }
    packed_nodes_[node_offset + n].first = static_cast<std::uint32_t>(packs_.size());
    for (std::uint32_t k = 0; k < node.count; k += 4) {
      TrianglePack& pack = packs_.emplace_back();
      for (std::uint32_t lane = 0; lane < 4; ++lane) {
        const std::uint32_t id = topology_.entries[node.first + std::min(k + lane, node.count - 1)];
        pack.id[lane] = id;
        for (std::size_t c = 0; c < 9; ++c) {
          pack.coordinate[c][lane] = (*triangles_)[id][c];
        }
      }
    }
  }
}

}  // namespace marti::accel
