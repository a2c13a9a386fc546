#include "accel/octree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

#include "accel/octree_sort.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

constexpr std::uint32_t deepest_level = 21;
constexpr double not_a_triangle = std::numeric_limits<double>::quiet_NaN();
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
    const bool may_split = level_splits(frame_, options_.max_level, level.number);
    for (std::size_t index = 0; index < level.cells.size(); ++index) {
      const std::size_t count = level.begin[index + 1] - level.begin[index];
      const std::size_t node = level.first_node + index;
      const std::uint64_t listed =
          topology_.entries.size() + next.lists.size() + (level.lists.size() - level.begin[index]);
      bool split = may_split && count > options_.max_objects && listed < options_.max_entries &&
                   topology_.nodes.size() < most_nodes;
      if (split) {
        sort_into_children(triangles_, frame_, {level.number, level.cells[index]},
                           std::span(level.lists).subspan(level.begin[index], count), sorted_);
        split = !separates_nothing(sorted_, count);
      }
      topology_.work[node].listed = static_cast<std::uint32_t>(count);
      if (split) {
        topology_.work[node].overlaps = sorted_.overlaps;
        topology_.nodes[node] = {static_cast<std::uint32_t>(topology_.nodes.size()), 8, level.number, false};
        for (std::uint32_t child = 0; child < 8; ++child) {
          next.cells.push_back(OctreeCell{level.number, level.cells[index]}.child(child).at);
          const std::vector<std::uint32_t>& list = sorted_.lists[child];
          next.lists.insert(next.lists.end(), list.begin(), list.end());
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
  const OctreeOptions& options_;
  const RootFrame& frame_;
  Topology& topology_;
  std::vector<LevelStatistics>& levels_;
  SortedChildren sorted_;
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
          pack.coordinate[c][lane] = id < triangles_->triangles() ? (*triangles_)[id][c] : not_a_triangle;
        }
      }
    }
  }
}

}  // namespace marti::accel
