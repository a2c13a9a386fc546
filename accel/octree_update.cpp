#include "accel/octree_update.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "accel/moved_primitives.h"
#include "accel/octree_sort.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

/// Walks both trees level by level, and decides in the order of the nodes, as the fresh build does.
class Updater {
 public:
  Updater(const Octree& before, const TriangleSet& after, const std::vector<std::uint32_t>& moved,
          OctreeUpdate& out)
      : before_(before),
        old_(before.topology()),
        options_(before.options()),
        frame_(before.frame()),
        was_(before.triangles()),
        is_(after),
        moved_(after.size(), false),
        out_(out) {
    for (const std::uint32_t id : moved) {
      moved_[id] = true;
    }
    Item root;
    root.old = 0;
    level_.ids = moved;
    level_.ids.insert(level_.ids.end(), moved.begin(), moved.end());
    root.left = {0, moved.size()};
    root.come = {moved.size(), 2 * moved.size()};
    root.count = was_.size();
    level_.items.push_back(root);
    level_.listed = root.count;
  }

  void run() {
    add_node(1);
    while (!level_.items.empty()) {
      update_level();
      std::swap(level_, next_);
    }
  }

 private:
  using Range = std::pair<std::size_t, std::size_t>;
  using Counts = std::array<std::uint32_t, 8>;

  /// A node of the new tree.
  struct Item {
    std::array<std::uint32_t, 3> at{};
    std::uint32_t old =
        no_old_node;        ///< the old tree's node of the same cell; none below a node that was split
    Range left;             ///< in Level::ids: the moved triangles that it listed before; empty without `old`
    Range come;             ///< the moved triangles that it lists now; without `old`, all its triangles
    std::size_t count = 0;  ///< triangles it lists

    [[nodiscard]] bool touched() const { return left.first != left.second || come.first != come.second; }
  };
  struct Level {
    std::uint32_t number = 1;
    std::vector<Item> items;
    std::vector<std::uint32_t> ids;
    std::uint64_t listed = 0;  ///< sum of the items' counts
  };

  void update_level() {
    next_ = Level{};
    next_.number = level_.number + 1;
    const bool splits = level_splits(frame_, options_.max_level, level_.number);
    LevelStatistics& statistics = out_.build.levels.emplace_back();
    std::uint64_t left = level_.listed;
    for (const Item& item : level_.items) {
      const bool full = splits && item.count > options_.max_objects;
      const bool room = out_.build.topology.entries.size() + next_.listed + left < options_.max_entries &&
                        out_.build.topology.nodes.size() < most_octree_nodes;
      out_.build.cut = out_.build.cut || (full && !room);
      out_.build.topology.work[number_].listed = static_cast<std::uint32_t>(item.count);
      out_.was[number_] = item.old;
      if (full && room && divide(item)) {
        ++statistics.branches;
      } else {
        leave(item, statistics);
      }
      left -= item.count;
      ++number_;
    }
  }

  /// Makes the node a branch if that separates anything.
  bool divide(const Item& item) {
    if (item.old != no_old_node) {
      const bool was_branch = !old_.nodes[item.old].leaf;
      if (!item.touched() && (was_branch || !before_.cut())) {
        // Nothing changes for it. A full leaf of a tree that was not cut could not be separated.
        if (was_branch) {
          keep(item);
        }
        return was_branch;
      }
      const std::size_t sorted = (item.left.second - item.left.first) + (item.come.second - item.come.first);
      if (was_branch && sorted <= item.count) {
        return resort(item);
      }
    }
    return split(item, list_of(item));
  }

  void keep(const Item& item) {
    out_.build.topology.work[number_] = old_.work[item.old];
    make_branch(NodeUpdate::kept);
    for (std::uint32_t child = 0; child < 8; ++child) {
      Item& below = add_item(item, child);
      below.old = old_.nodes[item.old].first + child;
      below.count = old_.work[below.old].listed;
      next_.listed += below.count;
    }
  }

  /// Moves only the moved triangles, from the children where they were to the children where they are.
  bool resort(const Item& item) {
    const ChildSorter<double> sorter(frame_, {level_.number, item.at});
    const std::uint32_t first = old_.nodes[item.old].first;
    Counts counts{};
    for (std::uint32_t child = 0; child < 8; ++child) {
      counts[child] = old_.work[first + child].listed;
    }
    const std::uint32_t tests_left = sort(sorter, was_, item.left, left_);
    const std::uint32_t tests_come = sort(sorter, is_, item.come, come_);
    for (std::size_t child = 0; child < 8; ++child) {
      counts[child] += static_cast<std::uint32_t>(come_[child].size());
      counts[child] -= static_cast<std::uint32_t>(left_[child].size());
    }
    const std::size_t sorted = (item.left.second - item.left.first) + (item.come.second - item.come.first);
    out_.work[number_] = {static_cast<std::uint32_t>(sorted), tests_left + tests_come};
    if (separates_nothing(counts, item.count)) {
      return false;
    }
    out_.build.topology.work[number_].overlaps = old_.work[item.old].overlaps - tests_left + tests_come;
    make_branch(NodeUpdate::resorted);
    for (std::uint32_t child = 0; child < 8; ++child) {
      Item& below = add_item(item, child);
      below.old = first + child;
      below.left = append(left_[child]);
      below.come = append(come_[child]);
      below.count = counts[child];
      next_.listed += below.count;
    }
    return true;
  }

  bool split(const Item& item, std::span<const std::uint32_t> list) {
    sort_into_children(is_, frame_, {level_.number, item.at}, list, sorted_);
    out_.work[number_] = {static_cast<std::uint32_t>(list.size()), sorted_.overlaps};
    if (separates_nothing(sorted_, list.size())) {
      return false;
    }
    out_.build.topology.work[number_].overlaps = sorted_.overlaps;
    make_branch(NodeUpdate::split);
    for (std::uint32_t child = 0; child < 8; ++child) {
      Item& below = add_item(item, child);
      below.come = append(sorted_.lists[child]);
      below.count = sorted_.lists[child].size();
      next_.listed += below.count;
    }
    return true;
  }

  void leave(const Item& item, LevelStatistics& statistics) {
    NodeUpdate& done = out_.nodes[number_];
    if (item.old == no_old_node) {
      done = NodeUpdate::made;
    } else if (!old_.nodes[item.old].leaf) {
      done = NodeUpdate::collapsed;
    } else if (item.touched()) {
      done = NodeUpdate::listed;
    }
    Topology& topology = out_.build.topology;
    const std::span<const std::uint32_t> list = list_of(item);
    sim::ensure(list.size() == item.count, "an updated leaf lists as many triangles as were counted");
    topology.nodes[number_] = {static_cast<std::uint32_t>(topology.entries.size()),
                               static_cast<std::uint32_t>(list.size()),
                               static_cast<std::uint8_t>(level_.number), true};
    topology.entries.insert(topology.entries.end(), list.begin(), list.end());
    ++statistics.leaves;
    statistics.entries += list.size();
    statistics.empty_leaves += list.empty() ? 1U : 0U;
    statistics.overfull_leaves += list.size() > options_.max_objects ? 1U : 0U;
  }

  /// All triangles that the item lists, ascending. Valid until the next call.
  std::span<const std::uint32_t> list_of(const Item& item) {
    const auto come = std::span(level_.ids).subspan(item.come.first, item.come.second - item.come.first);
    if (item.old == no_old_node) {
      return come;
    }
    if (old_.nodes[item.old].leaf && !item.touched()) {
      const TopologyNode& leaf = old_.nodes[item.old];
      return std::span(old_.entries).subspan(leaf.first, leaf.count);
    }
    stayed_.clear();
    gather_stayed(item.old);
    if (!old_.nodes[item.old].leaf) {
      std::sort(stayed_.begin(), stayed_.end());
      stayed_.erase(std::unique(stayed_.begin(), stayed_.end()), stayed_.end());
      if (stayed_.size() + come.size() < item.count) {
        add_lost(item);
      }
    }
    list_.clear();
    std::merge(stayed_.begin(), stayed_.end(), come.begin(), come.end(), std::back_inserter(list_));
    return list_;
  }

  /// Adds the unmoved triangles listed in the leaves at or below an old node; some appear repeatedly.
  void gather_stayed(std::uint32_t old) {
    const TopologyNode& node = old_.nodes[old];
    if (!node.leaf) {
      for (std::uint32_t child = 0; child < 8; ++child) {
        gather_stayed(node.first + child);
      }
      return;
    }
    for (const std::uint32_t id : std::span(old_.entries).subspan(node.first, node.count)) {
      if (!moved_[id]) {
        stayed_.push_back(id);
      }
    }
  }

  /// Adds the unmoved primitives that the item lists, but no leaf below its old node: a cone may be listed
  /// for a cell without need (quadric_overlap.h), and then for none of the cell's children.
  void add_lost(const Item& item) {
    std::vector<std::uint32_t> lost;
    for (std::uint32_t id = 0; id < is_.size(); ++id) {
      if (!moved_[id] && !std::binary_search(stayed_.begin(), stayed_.end(), id)) {
        lost.push_back(id);
      }
    }
    // The item lists a primitive that every cell above puts into the child on the way down to the item.
    for (std::uint32_t level = 1; level < level_.number; ++level) {
      const std::uint32_t below = level_.number - level;
      OctreeCell cell{level, {}};
      std::uint32_t child = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        cell.at[a] = item.at[a] >> below;
        child |= ((item.at[a] >> (below - 1)) & 1U) << a;
      }
      const ChildSorter<double> sorter(frame_, cell);
      std::uint32_t tests = 0;
      std::erase_if(lost,
                    [&](std::uint32_t id) { return ((sorter.children(is_, id, tests) >> child) & 1U) == 0; });
    }
    const auto added = stayed_.insert(stayed_.end(), lost.begin(), lost.end());
    std::inplace_merge(stayed_.begin(), added, stayed_.end());
  }

  /// Sorts moved triangles, with their coordinates in `triangles`, into lists for the children; returns the
  /// number of tests.
  std::uint32_t sort(const ChildSorter<double>& sorter, const TriangleSet& triangles, const Range& range,
                     std::array<std::vector<std::uint32_t>, 8>& lists) {
    for (auto& list : lists) {
      list.clear();
    }
    std::uint32_t tests = 0;
    for (std::size_t at = range.first; at < range.second; ++at) {
      const std::uint32_t id = level_.ids[at];
      for (std::uint32_t met = sorter.children(triangles, id, tests); met != 0; met &= met - 1) {
        lists[static_cast<std::size_t>(std::countr_zero(met))].push_back(id);
      }
    }
    return tests;
  }

  Range append(const std::vector<std::uint32_t>& ids) {
    const std::size_t begin = next_.ids.size();
    next_.ids.insert(next_.ids.end(), ids.begin(), ids.end());
    return {begin, next_.ids.size()};
  }

  void make_branch(NodeUpdate update) {
    Topology& topology = out_.build.topology;
    topology.nodes[number_] = {static_cast<std::uint32_t>(topology.nodes.size()), 8,
                               static_cast<std::uint8_t>(level_.number), false};
    out_.nodes[number_] = update;
    for (int child = 0; child < 8; ++child) {
      add_node(static_cast<std::uint8_t>(next_.number));
    }
  }

  Item& add_item(const Item& parent, std::uint32_t child) {
    Item& item = next_.items.emplace_back();
    item.at = OctreeCell{level_.number, parent.at}.child(child).at;
    return item;
  }

  void add_node(std::uint8_t level) {
    out_.build.topology.nodes.push_back({0, 0, level, true});
    out_.build.topology.work.emplace_back();
    out_.nodes.push_back(NodeUpdate::kept);
    out_.work.emplace_back();
    out_.was.push_back(no_old_node);
  }

  const Octree& before_;
  const Topology& old_;
  const OctreeOptions& options_;
  const RootFrame& frame_;
  const TriangleSet& was_;
  const TriangleSet& is_;
  std::vector<bool> moved_;
  OctreeUpdate& out_;
  Level level_;
  Level next_;
  std::size_t number_ = 0;  ///< number of the present node in the new tree
  std::array<std::vector<std::uint32_t>, 8> left_;
  std::array<std::vector<std::uint32_t>, 8> come_;
  SortedChildren sorted_;
  std::vector<std::uint32_t> stayed_;
  std::vector<std::uint32_t> list_;
};

}  // namespace

OctreeUpdate update_octree(const Octree& before, const TriangleSet& after) {
  OctreeUpdate update;
  const std::vector<std::uint32_t> moved = moved_primitives(before.triangles(), after);
  const RootFrame frame = make_frame(after, before.options().enclose);
  if (frame.box.lo != before.frame().box.lo || frame.box.hi != before.frame().box.hi ||
      frame.delta != before.frame().delta) {
    throw sim::UserError(
        "octree update: the triangles have left the box of the tree's root or changed its size, so no node "
        "can "
        "be kept; build the first tree with a box that encloses all frames");
  }
  update.moved = static_cast<std::uint32_t>(moved.size());
  Updater(before, after, moved, update).run();
  return update;
}

}  // namespace marti::accel
