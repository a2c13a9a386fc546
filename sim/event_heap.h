// The pending events as a 4-ary heap of 16-byte keys.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/event.h"
#include "sim/large_pages.h"

namespace marti::sim {

/// A priority queue of events.
class EventHeap {
 public:
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }

  void push(Event event) {
    heap_.push_back(event);
    std::size_t at = heap_.size() - 1;
    while (at > 0) {
      const std::size_t parent = (at - 1) / arity;
      if (!(event < heap_[parent])) {
        break;
      }
      heap_[at] = heap_[parent];
      at = parent;
    }
    heap_[at] = event;
  }

  /// The earliest event, or Event::never() while the heap is empty.
  [[nodiscard]] Event front() const { return heap_.empty() ? Event::never() : heap_.front(); }

  /// Calls soon(event) for the earliest event and later(event) for those of which one comes after it.
  template <class Later, class Soon>
  void look_ahead(const Later& later, const Soon& soon) const {
    for (std::size_t at = 1; at <= arity && at < heap_.size(); ++at) {
      later(heap_[at]);
    }
    if (!heap_.empty()) {
      soon(heap_.front());
    }
  }

  /// Removes the earliest event. The heap must not be empty.
  void pop() {
    const Event last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) {
      sift_down(last);
    }
  }

 private:
  static constexpr std::size_t arity = 4;

  // Puts `event` in the root's place and moves it down to its own.
  void sift_down(Event event) {
    const std::size_t size = heap_.size();
    std::size_t at = 0;
    for (;;) {
      const std::size_t first = at * arity + 1;
      if (first >= size) {
        break;
      }
      std::size_t least = first;
      if (first + arity <= size) [[likely]] {
        const std::size_t left = heap_[first + 1] < heap_[first] ? first + 1 : first;
        const std::size_t right = heap_[first + 3] < heap_[first + 2] ? first + 3 : first + 2;
        least = heap_[right] < heap_[left] ? right : left;
      } else {
        for (std::size_t child = first + 1; child < size; ++child) {
          least = heap_[child] < heap_[least] ? child : least;
        }
      }
      if (!(heap_[least] < event)) {
        break;
      }
      heap_[at] = heap_[least];
      at = least;
    }
    heap_[at] = event;
  }

  LargeVector<Event> heap_;
};

}  // namespace marti::sim
