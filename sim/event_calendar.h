// Pending events of the near future, by the day on which they come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/event.h"
#include "sim/large_pages.h"
#include "sim/number_set.h"

namespace marti::sim {

/// A calendar queue (R. Brown, "Calendar queues: a fast O(1) priority queue implementation for the simulation
/// event set problem", Communications of the ACM 31(10), 1988). Time is cut into days of 2^shift ticks. A
/// fixed number of days is open, beginning with the day of the present time; each has a sorted list of
/// events, whose first lies in the table of days itself, because most days have one event.
class EventCalendar {
 public:
  /// The table of more days would not stay near the host's processor.
  static constexpr std::uint32_t most_days = 4096;
  static_assert(most_days <= NumberSet::most);

  /// `days` is a power of two, at most most_days.
  explicit EventCalendar(std::uint32_t days) : days_(days), mask_(days - 1) {}

  static constexpr std::size_t bytes_a_day = 24;
  /// Bytes of host memory for each event that shares its day with others; tables grow by doubling.
  static constexpr std::size_t bytes_an_event = 2 * bytes_a_day;

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The earliest event, or Event::never() while the calendar is empty.
  [[nodiscard]] Event front() const { return days_[first_].event; }
  [[nodiscard]] unsigned shift() const { return shift_; }
  [[nodiscard]] std::uint32_t days() const { return mask_ + 1; }

  /// Changes the length of a day to 2^shift ticks. The calendar must be empty.
  void set_shift(unsigned shift) { shift_ = shift; }

  /// Inserts `event`, which is not earlier than `now`, the time of the event that the simulation handles.
  /// False, and nothing is done, when its day is not open or has many events.
  [[gnu::always_inline]] bool push(Event event, Ticks now) {
    const std::uint64_t ahead =
        (static_cast<std::uint64_t>(event.time) >> shift_) - (static_cast<std::uint64_t>(now) >> shift_);
    if (ahead > mask_) [[unlikely]] {
      return false;
    }
    const std::uint32_t day = day_of(event.time);
    if (days_[day].event.order == Event::never().order) [[likely]] {
      days_[day].event = event;
      busy_.insert(day);
    } else if (!push_into_list(days_[day], event)) {
      return false;
    }
    first_ = size_ == 0 || event < days_[first_].event ? day : first_;
    ++size_;
    return true;
  }

  /// Removes the earliest event. The calendar must not be empty.
  [[gnu::always_inline]] void pop() {
    Entry& day = days_[first_];
    --size_;
    if (day.next != none) [[unlikely]] {
      const std::uint32_t number = day.next;
      day = entries_[number];
      entries_[number].next = free_;
      free_ = number;
      return;
    }
    day.event = Event::never();
    busy_.erase(first_);
    if (size_ != 0) {
      first_ = busy_.next(first_);
    }
  }

  /// Calls soon(event) for the earliest event and later(event) for the one after it.
  template <class Later, class Soon>
  void look_ahead(const Later& later, const Soon& soon) const {
    if (size_ != 0) {
      const Entry& day = days_[first_];
      if (size_ != 1) {
        later(day.next != none ? entries_[day.next].event : days_[busy_.next((first_ + 1) & mask_)].event);
      }
      soon(day.event);
    }
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  static constexpr int longest_walk = 16;  // along the list of a day

  struct Entry {
    Event event = Event::never();
    std::uint32_t next = none;  // of its day, or of the entries that are free
  };
  static_assert(sizeof(Entry) == bytes_a_day);

  [[nodiscard]] std::uint32_t day_of(Ticks time) const {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(time) >> shift_) & mask_;
  }

  bool push_into_list(Entry& day, Event event) {
    if (event < day.event) {
      const std::uint32_t number = new_entry(day.event, day.next);
      day = {event, number};
      return true;
    }
    std::uint32_t before = none;
    std::uint32_t after = day.next;
    for (int walked = 0; after != none && entries_[after].event < event; ++walked) {
      if (walked == longest_walk) {
        return false;
      }
      before = after;
      after = entries_[after].next;
    }
    const std::uint32_t number = new_entry(event, after);
    (before == none ? day.next : entries_[before].next) = number;
    return true;
  }

  std::uint32_t new_entry(Event event, std::uint32_t next) {
    if (free_ == none) {
      entries_.push_back({event, next});
      return static_cast<std::uint32_t>(entries_.size() - 1);
    }
    const std::uint32_t number = free_;
    free_ = entries_[number].next;
    entries_[number] = {event, next};
    return number;
  }

  LargeVector<Entry> days_;     // the first event of each open day; day d stands at d modulo their number
  std::uint32_t mask_;          // number of days less 1
  NumberSet busy_;              // the days that have events
  LargeVector<Entry> entries_;  // further events
  std::uint32_t free_ = none;
  std::uint32_t first_ = 0;  // the day of the earliest event
  unsigned shift_ = 0;
  std::size_t size_ = 0;
};

}  // namespace marti::sim
