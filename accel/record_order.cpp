#include "accel/record_order.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace marti::accel {

namespace {

// Numbers records, one branch's children at a time.
class Ranks {
 public:
  Ranks(const Topology& topology, bool leaf_records)
      : topology_(topology),
        leaf_records_(leaf_records),
        ranks_(topology.nodes.size(), no_record),
        appended_(topology.nodes.size()) {
    if (!ranks_.empty()) {
      place(0);
    }
  }

  [[nodiscard]] std::uint32_t children_with_records(std::uint32_t branch) const {
    const TopologyNode& node = topology_.nodes[branch];
    std::uint32_t count = 0;
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      count += has_record(child) && !topology_.nodes[child].instance && ranks_[child] == no_record ? 1 : 0;
    }
    return count;
  }
  /// The root of a mesh is below all of its instances, and has one record.
  void place(std::uint32_t node) {
    if (has_record(node) && ranks_[node] == no_record) {
      ranks_[node] = topology_.nodes[node].instance ? next_transform_++ : next_++;
    }
  }
  void place_children(std::uint32_t branch) {
    const TopologyNode& node = topology_.nodes[branch];
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      place(child);
    }
  }
  /// Appends the children of a branch that are branches, in order; each once.
  void append_branches(std::uint32_t branch, std::vector<std::uint32_t>& list) {
    const TopologyNode& node = topology_.nodes[branch];
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      if (!topology_.nodes[child].leaf && !appended_[child]) {
        appended_[child] = true;
        list.push_back(child);
      }
    }
  }
  /// The root alone, if it is a branch.
  [[nodiscard]] std::vector<std::uint32_t> root() const {
    return ranks_.empty() || topology_.nodes[0].leaf ? std::vector<std::uint32_t>{}
                                                     : std::vector<std::uint32_t>{0};
  }
  /// How many node records have been placed.
  [[nodiscard]] std::uint32_t placed() const { return next_; }
  [[nodiscard]] std::vector<std::uint32_t> take() { return std::move(ranks_); }

 private:
  [[nodiscard]] bool has_record(std::uint32_t node) const {
    return leaf_records_ || !topology_.nodes[node].leaf;
  }

  const Topology& topology_;
  bool leaf_records_;
  std::vector<std::uint32_t> ranks_;
  std::vector<bool> appended_;
  std::uint32_t next_ = 0;
  std::uint32_t next_transform_ = 0;
};

}  // namespace

std::vector<std::uint32_t> breadth_first_rank(const Topology& topology, bool leaf_records) {
  Ranks ranks(topology, leaf_records);
  for (std::uint32_t node = 0; node < topology.nodes.size(); ++node) {
    ranks.place(node);
  }
  return ranks.take();
}

std::vector<std::uint32_t> depth_first_rank(const Topology& topology, bool leaf_records) {
  Ranks ranks(topology, leaf_records);
  std::vector<std::uint32_t> pending = ranks.root();
  while (!pending.empty()) {
    const std::uint32_t branch = pending.back();
    pending.pop_back();
    ranks.place_children(branch);
    const auto below = static_cast<std::ptrdiff_t>(pending.size());
    ranks.append_branches(branch, pending);
    std::reverse(pending.begin() + below, pending.end());
  }
  return ranks.take();
}

Treelets treelets_of(const Topology& topology, bool leaf_records, std::uint32_t most) {
  Ranks ranks(topology, leaf_records);
  Treelets treelets;
  std::vector<std::uint32_t> tops = ranks.root();
  std::uint32_t used = 1;  // the first treelet has the root's record
  treelets.begin.push_back(0);
  while (!tops.empty()) {
    if (used == 0) {
      treelets.begin.push_back(ranks.placed());
    }
    std::vector<std::uint32_t> treelet = {tops.back()};
    tops.pop_back();
    std::size_t taken = 0;
    for (; taken < treelet.size(); ++taken) {
      const std::uint32_t records = ranks.children_with_records(treelet[taken]);
      if (used != 0 && std::uint64_t{used} + records > most) {
        break;
      }
      used += records;
      ranks.place_children(treelet[taken]);
      ranks.append_branches(treelet[taken], treelet);
    }
    tops.insert(tops.end(), treelet.rbegin(), treelet.rend() - static_cast<std::ptrdiff_t>(taken));
    used = 0;
  }
  treelets.begin.push_back(ranks.placed());
  treelets.rank = ranks.take();
  // Of a leaf without a record, and of an instance, that of its parent, which comes before it.
  treelets.of_node.resize(topology.nodes.size());
  for (std::uint32_t node = 0; node < topology.nodes.size(); ++node) {
    if (const std::uint32_t rank = treelets.rank[node]; rank != no_record && !topology.nodes[node].instance) {
      const auto next = std::upper_bound(treelets.begin.begin(), treelets.begin.end(), rank);
      treelets.of_node[node] = static_cast<std::uint32_t>(next - treelets.begin.begin()) - 1;
    }
    const TopologyNode& branch = topology.nodes[node];
    if (!branch.leaf) {
      std::fill_n(treelets.of_node.begin() + branch.first, branch.count, treelets.of_node[node]);
    }
  }
  return treelets;
}

}  // namespace marti::accel
