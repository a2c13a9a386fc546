// Pending events of few components, each with at most one.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "sim/event.h"

namespace marti::sim {

/// A winner tree (Knuth, The Art of Computer Programming 3, section 5.4.1): a complete binary tree with a
/// leaf for each component, in which every inner node holds the earlier event of its two children. An event
/// takes one way from its leaf to the root, without a branch that depends on times. A component often posts
/// its next event while its last one is handled, so the tree is not changed when an event is popped: the next
/// event of the leaf takes its place.
class EventTree {
 public:
  /// With more components than this the way to the root takes longer than a calendar.
  static constexpr std::uint32_t most = 8;

  /// For components below `components`, at most `most`; with 0 it takes no events.
  explicit EventTree(std::uint32_t components)
      : leaves_(components == 0 ? 0 : std::bit_ceil(components)),
        events_(std::max(2U, 2 * leaves_), Event::never()) {}

  /// At most this many; a power of two, or 0.
  [[nodiscard]] std::uint32_t components() const { return leaves_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Whether push() may be called for an event of this component: it has none, and a leaf.
  [[nodiscard]] bool takes(std::uint32_t component) const {
    return component < leaves_ &&
           (component + leaves_ == popped_ || events_[component + leaves_].order == Event::never().order);
  }

  void push(Event event) {
    const std::uint32_t leaf = event.component() + leaves_;
    if (popped_ != leaf) [[unlikely]] {
      settle();
    }
    popped_ = none;
    put(leaf, event);
    ++size_;
  }

  /// The earliest event, or Event::never() while the tree is empty.
  [[nodiscard]] Event front() {
    settle();
    return events_[1];
  }
  /// Removes the earliest event. front() must have been called since the last change.
  void pop() {
    popped_ = events_[1].component() + leaves_;
    --size_;
  }

 private:
  static constexpr std::uint32_t none = 0;  // no leaf has this number

  // Empties the leaf of the event that was popped last.
  void settle() {
    if (popped_ != none) {
      put(popped_, Event::never());
      popped_ = none;
    }
  }

  void put(std::uint32_t at, Event event) {
    events_[at] = event;
    while (at > 1) {
      // The earlier of the two by a mask: compilers make branches of conditional expressions here.
      const Event& other = events_[at ^ 1U];
      const std::uint64_t mask = -static_cast<std::uint64_t>(other < event);
      event.time ^= static_cast<Ticks>(static_cast<std::uint64_t>(event.time ^ other.time) & mask);
      event.order ^= (event.order ^ other.order) & mask;
      at /= 2;
      events_[at] = event;
    }
  }

  std::uint32_t leaves_;
  std::uint32_t popped_ = none;  // the leaf of an event that is popped and still in the tree
  std::size_t size_ = 0;
  std::vector<Event> events_;  // the root is 1, the children of i are 2 i and 2 i + 1
};

}  // namespace marti::sim
