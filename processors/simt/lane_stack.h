// The entries that a lane keeps while its ray walks through a bounding volume hierarchy
// (docs/internals/rt-unit.md, Prefetching into the unit): children of branches that the ray has entered,
// which wait for their visits.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/topology.h"
#include "accel/visitor.h"
#include "sim/error.h"

namespace marti::processors::simt {

class LaneStack {
 public:
  /// Puts the lane before a pixel, of which `entered` is what WorkLog::entered() says.
  void begin_pixel(std::span<const std::uint32_t> entered) { entered_ = entered.data(); }

  void begin_ray() {
    waiting_.assign(1, 0);
    children_ = {0, 1};
    entered_now_ = 1;
  }
  /// The ray visits no further node: what still waits is dropped.
  void end_ray() {
    waiting_.clear();
    entered_now_ = 0;
  }

  /// Of the children that the ray has entered in its last visit it keeps the nearest, which it takes next; so
  /// many it has pushed.
  [[nodiscard]] std::uint32_t pushed() const { return entered_now_ == 0 ? 0 : entered_now_ - 1; }
  /// How many entries it pops from those that it has pushed to go on with a node, or to drop them all.
  [[nodiscard]] std::uint32_t popped_for(std::uint32_t node) const {
    const auto taken = std::find(waiting_.rbegin(), waiting_.rend(), node);
    sim::ensure(taken != waiting_.rend(), "a ray of the work log visits a node that it has not entered");
    return static_cast<std::uint32_t>(taken - waiting_.rbegin()) + (entered_now_ == 0 ? 1 : 0);
  }
  [[nodiscard]] std::uint32_t popped_for_all() const {
    return static_cast<std::uint32_t>(waiting_.size()) - (entered_now_ == 0 ? 0 : 1);
  }

  /// The ray goes on with a node. If that is neither the root nor a child of the branch visited before, calls
  /// use(node) for at most `most` of the entries that wait, in the order in which they would be taken.
  template <class Use>
  void visit(const std::vector<accel::TopologyNode>& tree, std::uint32_t node, std::uint32_t most,
             const Use& use) {
    std::uint32_t taken = 0;
    do {
      sim::ensure(!waiting_.empty(), "a ray of the work log visits a node that it has not entered");
      taken = waiting_.back();
      waiting_.pop_back();
    } while (taken != node);  // those above it were dropped
    if (node - children_.first >= children_.count) {
      for (std::size_t i = 0; i < std::min<std::size_t>(most, waiting_.size()); ++i) {
        use(waiting_[waiting_.size() - 1 - i]);
      }
    }
    children_ = {};
    entered_now_ = 0;
    if (tree[node].leaf) {
      return;
    }
    children_ = {tree[node].first, tree[node].count};
    const accel::EnteredChildren entered(*entered_++);
    entered_now_ = entered.count();
    for (std::uint32_t place = entered.count(); place-- > 0;) {
      waiting_.push_back(children_.first + entered[place]);
    }
  }

 private:
  struct Children {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  const std::uint32_t* entered_ = nullptr;  // of the next branch
  std::vector<std::uint32_t> waiting_;      // the next one last
  Children children_;                       // of the branch visited last, if that was the last visit
  std::uint32_t entered_now_ = 0;           // of these, how many were entered
};

}  // namespace marti::processors::simt
