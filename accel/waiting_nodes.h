// The nodes of a bounding volume hierarchy that a ray has entered and not taken, in any order of
// walk_order.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "accel/walk_order.h"

namespace marti::accel {

/// `Waiting` has a member `number`, the node's.
template <class Waiting>
class WaitingNodes {
 public:
  /// `treelet`: of each node; used with WalkOrder::treelet_first.
  WaitingNodes(WalkOrder order, std::span<const std::uint32_t> treelet) : order_(order), treelet_(treelet) {}

  /// Adds a branch's children, the nearest first.
  void add(const Waiting* children, std::size_t count) {
    if (order_ == WalkOrder::breadth_first) {
      nodes_.insert(nodes_.end(), children, children + count);
    } else {
      nodes_.insert(nodes_.end(), std::make_reverse_iterator(children + count),
                    std::make_reverse_iterator(children));
    }
  }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] std::size_t size() const { return nodes_.size() - next_; }
  /// Takes the next node. `visited`: the one visited last.
  Waiting take(std::uint32_t visited) {
    if (order_ == WalkOrder::breadth_first) {
      return nodes_[next_++];
    }
    std::size_t at = nodes_.size() - 1;
    if (order_ == WalkOrder::treelet_first) {
      const std::uint32_t present = treelet_[visited];
      std::size_t below = nodes_.size();
      while (below > 0 && treelet_[nodes_[below - 1].number] != present) {
        --below;
      }
      at = below > 0 ? below - 1 : at;
    }
    const Waiting taken = nodes_[at];
    nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(at));
    return taken;
  }
  /// Takes the node that was added first, of children added together the one that take() would take last,
  /// or, breadth first, first.
  Waiting take_oldest() {
    if (order_ == WalkOrder::breadth_first) {
      return nodes_[next_++];
    }
    const Waiting taken = nodes_.front();
    nodes_.erase(nodes_.begin());
    return taken;
  }
  void clear() {
    nodes_.clear();
    next_ = 0;
  }

 private:
  WalkOrder order_;
  std::span<const std::uint32_t> treelet_;
  std::vector<Waiting> nodes_;
  std::size_t next_ = 0;  // breadth first: those before it are taken
};

}  // namespace marti::accel
