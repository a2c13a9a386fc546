// Pending events that are pushed nearly in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "sim/event.h"
#include "sim/large_pages.h"

namespace marti::sim {

/// A sorted ring of events. Pushing walks back from the latest event, so it takes constant time where events
/// come nearly in their order, as the replies of a queue do that serves requests in the order of arrival.
class EventLane {
 public:
  EventLane() : ring_(fewest), events_(ring_.data()), mask_(fewest - 1) {}
  EventLane(const EventLane&) = delete;
  EventLane& operator=(const EventLane&) = delete;
  EventLane(EventLane&&) = default;
  EventLane& operator=(EventLane&&) = default;
  ~EventLane() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The earliest event; one later than all others when the lane is empty.
  [[nodiscard]] Event front() const { return front_; }

  /// Calls later(event) for an event that a few others come before, and soon(event) for one that is nearly
  /// the next: as events are popped, for nearly every event first the one and then the other.
  template <class Later, class Soon>
  void look_ahead(const Later& later, const Soon& soon) const {
    if (size_ != 0) {
      later(at(std::min(size_ - 1, before_later)));
      soon(at(std::min(size_ - 1, before_soon)));
    }
  }

  /// Inserts `event`. False, and nothing is done, when more than a few events are later.
  [[gnu::always_inline]] bool push(Event event) {
    if (size_ > mask_) [[unlikely]] {
      grow();
    }
    if (size_ != 0 && event < at(size_ - 1)) {
      return push_before_last(event);
    }
    at(size_) = event;
    front_ = size_ == 0 ? event : front_;
    ++size_;
    return true;
  }

  /// Removes and returns the earliest event. The lane must not be empty.
  Event pop() {
    const Event event = front_;
    first_ = (first_ + 1) & mask_;
    --size_;
    front_ = size_ == 0 ? Event::never() : events_[first_];
    return event;
  }

 private:
  static constexpr std::size_t fewest = 16;  // a power of two
  static constexpr std::size_t longest_walk = 64;
  static constexpr std::size_t before_later = 8;
  static constexpr std::size_t before_soon = 3;

  [[nodiscard]] Event& at(std::size_t number) const { return events_[(first_ + number) & mask_]; }

  [[gnu::noinline]] bool push_before_last(Event event) {
    std::size_t later = 1;
    while (later < size_ && event < at(size_ - 1 - later)) {
      if (++later > longest_walk) {
        return false;
      }
    }
    for (std::size_t moved = 0; moved < later; ++moved) {
      at(size_ - moved) = at(size_ - 1 - moved);
    }
    at(size_ - later) = event;
    ++size_;
    front_ = events_[first_];
    return true;
  }

  void grow() {
    LargeVector<Event> ring(2 * ring_.size());
    for (std::size_t number = 0; number < size_; ++number) {
      ring[number] = at(number);
    }
    ring_ = std::move(ring);
    events_ = ring_.data();
    mask_ = ring_.size() - 1;
    first_ = 0;
  }

  LargeVector<Event> ring_;  // its size is a power of two
  Event* events_;            // of the ring
  std::size_t mask_;         // its size less 1
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  Event front_ = Event::never();
};

}  // namespace marti::sim
