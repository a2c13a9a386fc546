// Addresses of a tree's records and lists in one of its copies.
#pragma once

#include "processors/node/tree_copies.h"
#include "sim/error.h"

namespace marti::processors::node {

/// Keeps references. A node must exist (its parent be split) when its address is asked for.
class TreeAddresses {
 public:
  TreeAddresses(const walk::TreePlan& plan, const accel::Topology& topology, const memory::Layout& layout,
                const TreeCopies& copies)
      : plan_(plan), topology_(topology), layout_(layout), copies_(copies) {}

  /// Whether each private tree has a record of its own for this node of the initial tree.
  [[nodiscard]] bool has_slot(const walk::TreePlan::Place& place) const {
    return place.lazy != walk::TreePlan::none && plan_.lazy()[place.lazy].slot != walk::TreePlan::none;
  }
  /// The record of a node of the initial tree in the database.
  [[nodiscard]] memory::Address initial_record(std::uint32_t node) const {
    return layout_.address(memory::RecordKind::node, plan_.place(node).record);
  }
  /// The record that a visit to the node reads first.
  [[nodiscard]] memory::Address record(std::uint32_t copy, std::uint32_t node) const {
    const walk::TreePlan::Place& place = plan_.place(node);
    if (place.home != walk::TreePlan::none) {
      return block_of(copy, place) + place.record * plan_.stride();
    }
    if (has_slot(place)) {
      return plan_.slot_address(plan_.lazy()[place.lazy].slot);
    }
    return initial_record(node);
  }
  /// The list of a leaf, or of a branch before it is split.
  [[nodiscard]] memory::Address list(std::uint32_t copy, std::uint32_t node) const {
    const walk::TreePlan::Place& place = plan_.place(node);
    if (place.home != walk::TreePlan::none) {
      return block_of(copy, place) + place.list;
    }
    if (!topology_.nodes[node].leaf && place.lazy == walk::TreePlan::none) {
      return plan_.dynamic_base() + place.list;
    }
    return layout_.address(memory::RecordKind::list, place.list);
  }

 private:
  [[nodiscard]] memory::Address block_of(std::uint32_t copy, const walk::TreePlan::Place& place) const {
    const memory::Address block = copies_.block(copy, place.home);
    sim::ensure(block != 0, "the log visits a node before its parent");
    return block;
  }

  const walk::TreePlan& plan_;
  const accel::Topology& topology_;
  const memory::Layout& layout_;
  const TreeCopies& copies_;
};

}  // namespace marti::processors::node
