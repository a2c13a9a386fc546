// The pending events, earliest first.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/event.h"
#include "sim/event_calendar.h"
#include "sim/event_heap.h"
#include "sim/event_lane.h"
#include "sim/event_tree.h"
#include "sim/later_years.h"

namespace marti::sim {

/// A priority queue of events: a calendar for the near future, a lane for events that are pushed nearly in
/// order, and a heap for what fits into neither. The length of the calendar's days follows from how far ahead
/// events are pushed, so that pushing and popping take constant time. Where there are many components, the
/// calendar is of one year, and what comes in later years is kept apart until its year begins. Where there
/// are few, a tree has one event of each, and the others only what the tree has no place for. What is popped
/// does not depend on where events are kept: it is the earliest of all.
///
/// An event that is pushed must not be earlier than the one popped last.
class EventQueue {
 public:
  EventQueue() : tree_(0), calendar_(fewest_days), later_years_(1) {}

  /// Bytes of host memory for each pending event, and beside them for a queue of so many.
  static constexpr std::size_t bytes_an_event = EventCalendar::bytes_an_event + LaterYears::bytes_an_event;
  [[nodiscard]] static std::size_t bytes_of_days(std::size_t events) {
    return EventCalendar::bytes_a_day * days_for(events) + LaterYears::bytes_a_year * years_for(events);
  }

  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] std::size_t size() const {
    return tree_.size() + lane_.size() + calendar_.size() + later_years_.size() + heap_.size();
  }
  /// Chooses the number of days for so many pending events. The queue must be empty.
  void reserve(std::size_t events) {
    calendar_ = EventCalendar(days_for(events));
    later_years_ = LaterYears(years_for(events));
    set_shift(0);
    many_expected_ = events > many / 2;
  }
  /// reserve() for events of components below `components` that seldom have more than one each.
  void reserve_for(std::size_t components) {
    tree_ = EventTree(components <= EventTree::most ? static_cast<std::uint32_t>(components) : 0);
    reserve(components);
  }

  [[gnu::always_inline]] void push(Event event) {
    if (tree_.takes(event.component())) {
      tree_.push(event);
    } else {
      push_outside(event);
    }
  }

  /// push() for an event that is likely to be later than those that were pushed in this way before.
  [[gnu::always_inline]] void push_in_order(Event event) {
    if (tree_.takes(event.component())) {
      tree_.push(event);
    } else if (!lane_.push(event)) [[unlikely]] {
      push_outside(event);
    }
  }

  /// Whether events are kept in the tree.
  [[nodiscard]] bool has_tree() const { return tree_.components() != 0; }
  /// Whether the earliest event lies in the tree.
  [[nodiscard]] bool next_is_in_tree() { return tree_.front() < std::min(lane_.front(), first_); }
  /// Whether the earliest event lies in the lane, if not in the tree. All events there are of
  /// push_in_order(); some of those, which came too far out of order, are elsewhere.
  [[nodiscard]] bool next_is_in_order() const { return lane_.front() < first_; }

  /// Whether no event is pending where not next_is_in_tree() and not next_is_in_order().
  [[nodiscard]] bool has_no_other() const { return first_.order == Event::never().order; }
  /// Whether so many events are pending, and were expected by reserve(), that the host's caches may not hold
  /// all that belongs to them. Those of the heap, of which there are few, are not counted.
  [[nodiscard]] bool many_pending() const {
    return many_expected_ && lane_.size() + calendar_.size() + later_years_.size() > many;
  }

  /// Calls later(event) for some events that will be popped soon unless earlier ones are pushed, and
  /// soon(event) for some that may be next.
  template <class Later, class Soon>
  void look_ahead(const Later& later, const Soon& soon) const {
    lane_.look_ahead(later, soon);
    calendar_.look_ahead(later, soon);
    heap_.look_ahead(later, soon);
  }

  /// The earliest event; Event::never() if the queue is empty.
  [[nodiscard]] Event front() { return std::min(tree_.front(), std::min(lane_.front(), first_)); }

  /// Removes and returns the earliest event. The queue must not be empty.
  Event pop() {
    return next_is_in_tree() ? pop_in_tree() : next_is_in_order() ? pop_in_order() : pop_other();
  }
  /// pop() where next_is_in_tree().
  [[gnu::always_inline]] Event pop_in_tree() {
    const Event event = tree_.front();
    tree_.pop();
    last_ = event.time;
    return event;
  }
  /// pop() where not next_is_in_tree(), but next_is_in_order().
  [[gnu::always_inline]] Event pop_in_order() {
    const Event event = lane_.pop();
    last_ = event.time;
    return event;
  }
  /// pop() where neither.
  [[gnu::always_inline]] Event pop_other() {
    const Event event = first_;
    last_ = event.time;
    if (calendar_.front() < heap_first_) [[likely]] {
      calendar_.pop();
      if (calendar_.size() == 0 && later_years_.size() != 0) [[unlikely]] {
        open_next_year();
      }
    } else {
      heap_.pop();
      heap_first_ = heap_.front();
    }
    first_ = std::min(calendar_.front(), heap_first_);
    return event;
  }

 private:
  static constexpr std::size_t many = 2048;
  static constexpr std::uint32_t fewest_days = 256;
  static constexpr std::uint64_t tuned_after = 1024;  // pushed events
  static constexpr std::uint32_t farther = 4;

  [[gnu::always_inline]] void push_outside(Event event) {
    ahead_ += static_cast<std::uint64_t>(event.time - last_);
    keep(event);
    if (event < first_) {
      first_ = event;
    }
    if (++pushed_ == tuned_at_) [[unlikely]] {
      tune();
    }
  }

  [[gnu::always_inline]] void keep(Event event) {
    if (later_years_.on()) [[unlikely]] {
      keep_by_year(event);
    } else if (!calendar_.push(event, last_)) [[unlikely]] {
      push_into_heap(event);
    }
  }

  // While the calendar is empty, so are the years after it. So what lies in these never comes before an event
  // of the calendar.
  [[gnu::noinline]] void keep_by_year(Event event) {
    const std::uint64_t year = later_years_.year_of(event.time);
    if (calendar_.size() == 0 && year > later_years_.open_year()) {
      later_years_.open(year);
    }
    const bool kept = year == later_years_.open_year()  ? calendar_.push(event, later_years_.begin())
                      : year > later_years_.open_year() ? later_years_.push(event)
                                                        : false;
    if (!kept) {
      push_into_heap(event);
    }
  }

  [[gnu::noinline]] void open_next_year() {
    later_years_.open_next([this](Event event) {
      if (!calendar_.push(event, later_years_.begin())) {
        push_into_heap(event);
      }
    });
  }

  void push_into_heap(Event event) {
    heap_.push(event);
    heap_first_ = heap_.front();
  }

  // Four to eight for each event, so that most days have at most one.
  [[nodiscard]] static std::size_t wanted_days(std::size_t events) {
    constexpr std::size_t most = std::size_t{EventCalendar::most_days} * LaterYears::most / farther;
    return std::clamp<std::size_t>(events >= most ? most : 4 * std::bit_ceil(events), fewest_days, most);
  }
  [[nodiscard]] static std::uint32_t days_for(std::size_t events) {
    return static_cast<std::uint32_t>(std::min<std::size_t>(wanted_days(events), EventCalendar::most_days));
  }
  [[nodiscard]] static std::uint32_t years_for(std::size_t events) {
    const std::size_t years = wanted_days(events) / days_for(events);
    return static_cast<std::uint32_t>(years == 1 ? 1 : farther * years);
  }

  // Calendar and years must be empty.
  void set_shift(unsigned shift) {
    calendar_.set_shift(shift);
    const auto year = shift + static_cast<unsigned>(std::countr_zero(calendar_.days()));
    later_years_.set_shift(std::min(year, 63U), last_);
  }

  // Chooses the length of a day so that all days are four to sixteen times as long as events are pushed ahead
  // on average, and with later years, which cost little, `farther` times that.
  void tune() {
    const double ahead = static_cast<double>(ahead_) / static_cast<double>(tuned_after_last_);
    const double wanted = 4.0 * ahead * (later_years_.on() ? farther : 1) /
                          (static_cast<double>(calendar_.days()) * static_cast<double>(later_years_.years()));
    const auto shift =
        wanted < 1.0 ? 0U : static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(wanted)));
    if (shift > calendar_.shift() || shift + 1 < calendar_.shift()) {
      std::vector<Event> events;
      events.reserve(calendar_.size() + later_years_.size());
      for (; calendar_.size() != 0; calendar_.pop()) {
        events.push_back(calendar_.front());
      }
      while (later_years_.size() != 0) {
        later_years_.open_next([&events](Event event) { events.push_back(event); });
      }
      set_shift(shift);
      for (const Event& event : events) {
        keep(event);
      }
      first_ = std::min(calendar_.front(), heap_first_);
    }
    ahead_ = 0;
    tuned_after_last_ = std::max<std::uint64_t>(tuned_after, 8 * size());
    tuned_at_ = pushed_ + tuned_after_last_;
  }

  EventTree tree_;
  EventLane lane_;
  EventCalendar calendar_;
  LaterYears later_years_;
  EventHeap heap_;
  Event heap_first_ = Event::never();  // the earliest of the heap
  Event first_ = Event::never();       // the earliest of calendar and heap
  Ticks last_ = 0;                     // time of the event popped last
  __extension__ using Sum = unsigned __int128;
  bool many_expected_ = false;
  Sum ahead_ = 0;  // sum over the events pushed since the last tuning: ticks from the event popped last
  std::uint64_t pushed_ = 0;
  std::uint64_t tuned_at_ = tuned_after;
  std::uint64_t tuned_after_last_ = tuned_after;
};

}  // namespace marti::sim
