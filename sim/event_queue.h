// The pending events, earliest first.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/event.h"
#include "sim/event_heap.h"
#include "sim/large_pages.h"
#include "sim/number_set.h"

namespace marti::sim {

/// A priority queue of events: a calendar of short days for the near future (R. Brown, "Calendar queues: a
/// fast O(1) priority queue implementation for the simulation event set problem", Communications of the ACM
/// 31(10), 1988), and a heap for what does not fit there. The events of a day are a sorted list, and the
/// length of a day follows from how far ahead events are pushed, so that pushing and popping take constant
/// time. What is popped never depends on the calendar: it is the earlier of the calendar's first event and
/// the heap's.
///
/// An event that is pushed must not be earlier than the one popped last.
class EventQueue {
 public:
  EventQueue() : days_(few_days, none), busy_days_(few_days) {}

  /// Bytes of host memory for each pending event.
  static constexpr std::size_t bytes_an_event = 24 + sizeof(Event);

  [[nodiscard]] bool empty() const { return in_calendar_ == 0 && heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return in_calendar_ + heap_.size(); }
  /// For so many pending events. The queue must be empty.
  void reserve(std::size_t events) {
    entries_.reserve(events);
    if (events > few_days) {
      days_.assign(NumberSet::most, none);
      busy_days_ = NumberSet(NumberSet::most);
    }
  }

  void push(const Event& event) {
    ahead_ += static_cast<double>(event.time - last_);
    if (!push_into_calendar(event)) {
      heap_.push(event);
    }
    if (++pushed_ == tuned_at_) [[unlikely]] {
      tune();
    }
  }

  /// Calls visit(event) for a few events that may be next unless an earlier one is pushed.
  template <class Visit>
  void each_likely_next(const Visit& visit) const {
    if (in_calendar_ != 0) {
      std::uint32_t number = days_[first_day()];
      for (int count = 0; count < 2 && number != none; ++count) {
        visit(entries_[number].event);
        number = entries_[number].next;
      }
    }
    heap_.each_likely_next(visit);
  }

  /// Removes and returns the earliest event. The queue must not be empty.
  Event pop() {
    if (in_calendar_ != 0) [[likely]] {
      const std::uint32_t day = first_day();
      if (heap_.empty() || entries_[days_[day]].event < heap_.front()) {
        return pop_of(day);
      }
    }
    const Event event = heap_.pop();
    last_ = event.time;
    return event;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  static constexpr std::uint32_t few_days = 64 * 64;
  static constexpr int longest_walk = 16;             // along the list of a day
  static constexpr std::uint64_t tuned_after = 1024;  // pushed events

  struct Entry {
    Event event;
    std::uint32_t next = none;  // of its day, or of the entries that are free
  };
  static_assert(sizeof(Entry) + sizeof(Event) == bytes_an_event);

  // Days are counted from time 0; those that are open, as many as days_ has, begin with that of last_.
  [[nodiscard]] std::uint32_t place_of(Ticks time) const {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(time) >> shift_) &
           (static_cast<std::uint32_t>(days_.size()) - 1U);
  }
  [[nodiscard]] std::uint32_t first_day() const { return busy_days_.next(place_of(last_)); }

  // False when the event is on a day that is not open, or its day has many events.
  bool push_into_calendar(const Event& event) {
    const std::uint64_t days_ahead =
        (static_cast<std::uint64_t>(event.time) >> shift_) - (static_cast<std::uint64_t>(last_) >> shift_);
    if (days_ahead >= days_.size()) {
      return false;
    }
    const std::uint32_t day = place_of(event.time);
    std::uint32_t* link = &days_[day];
    if (*link == none) {
      busy_days_.insert(day);
    } else {
      for (int walked = 0; *link != none && entries_[*link].event < event; ++walked) {
        if (walked == longest_walk) {
          return false;
        }
        link = &entries_[*link].next;
      }
    }
    const std::uint32_t next = *link;
    if (free_ != none) [[likely]] {
      const std::uint32_t number = free_;
      free_ = entries_[number].next;
      entries_[number] = {event, next};
      *link = number;
    } else {
      *link = static_cast<std::uint32_t>(entries_.size());  // before push_back, which may move the link
      entries_.push_back({event, next});
    }
    ++in_calendar_;
    return true;
  }

  Event pop_of(std::uint32_t day) {
    const std::uint32_t number = days_[day];
    Entry& entry = entries_[number];
    days_[day] = entry.next;
    if (entry.next == none) {
      busy_days_.erase(day);
    }
    entry.next = free_;
    free_ = number;
    --in_calendar_;
    last_ = entry.event.time;
    return entry.event;
  }

  // Chooses the length of a day so that the open days are four to sixteen times as long as events are pushed
  // ahead on average.
  void tune() {
    const double wanted =
        4.0 * ahead_ / static_cast<double>(tuned_after_last_) / static_cast<double>(days_.size());
    const auto shift =
        wanted < 1.0 ? 0U : static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(wanted)));
    if (shift > shift_ || shift + 1 < shift_) {
      std::vector<Event> events;
      events.reserve(in_calendar_);
      const Ticks last = last_;
      while (in_calendar_ != 0) {
        events.push_back(pop_of(first_day()));
      }
      last_ = last;
      shift_ = shift;
      for (const Event& event : events) {
        if (!push_into_calendar(event)) {
          heap_.push(event);
        }
      }
    }
    ahead_ = 0.0;
    tuned_after_last_ = std::max<std::uint64_t>(tuned_after, 8 * size());
    tuned_at_ = pushed_ + tuned_after_last_;
  }

  EventHeap heap_;
  LargeVector<std::uint32_t> days_;  // the first entry of each open day
  NumberSet busy_days_;              // those that have events
  LargeVector<Entry> entries_;
  std::uint32_t free_ = none;
  std::size_t in_calendar_ = 0;
  unsigned shift_ = 0;  // a day has 2^shift_ ticks
  Ticks last_ = 0;      // time of the event popped last
  double ahead_ = 0.0;  // sum over the events pushed since the last tuning: ticks from the event popped last
  std::uint64_t pushed_ = 0;
  std::uint64_t tuned_at_ = tuned_after;
  std::uint64_t tuned_after_last_ = tuned_after;
};

}  // namespace marti::sim
