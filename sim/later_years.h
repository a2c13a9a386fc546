// Pending events of the far future, by the year in which they come.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/event.h"
#include "sim/large_pages.h"
#include "sim/number_set.h"

namespace marti::sim {

/// A year is as long as a calendar with all its days (event_calendar.h). The events of a fixed number of
/// years after the one that is open lie in no order, as in the first rung of a ladder queue (W. T. Tang, R.
/// S. M. Goh, I. L.-J. Thng, "Ladder queue: an O(1) priority queue structure for large-scale discrete event
/// simulation", ACM TOMACS 15(3), 2005), in blocks that are written and read from end to end: where many
/// events are pending, the host's caches need hold only the open year and the last block of each later one.
class LaterYears {
 public:
  static constexpr std::uint32_t most = 4096;
  static_assert(most <= NumberSet::most);

  /// `years` is a power of two, at most `most`. With 1 there are none that take events.
  explicit LaterYears(std::uint32_t years) : mask_(years - 1), last_block_(years, none) {}

  /// Bytes of host memory for each year beside its events.
  static constexpr std::size_t bytes_a_year = 512;
  /// Bytes of host memory for each event: its part of a block, three times, because the table of blocks grows
  /// by doubling and the old one is there until the new one is filled.
  static constexpr std::size_t bytes_an_event = std::size_t{3} * 256 / 15;

  [[nodiscard]] bool on() const { return mask_ != 0; }
  [[nodiscard]] std::uint32_t years() const { return mask_ + 1; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The open year, and when it begins.
  [[nodiscard]] std::uint64_t open_year() const { return open_; }
  [[nodiscard]] Ticks begin() const { return static_cast<Ticks>(open_ << shift_); }
  [[nodiscard]] std::uint64_t year_of(Ticks time) const { return static_cast<std::uint64_t>(time) >> shift_; }

  /// Changes the length of a year to 2^shift ticks and opens that of `now`. There must be no events.
  void set_shift(unsigned shift, Ticks now) {
    shift_ = shift;
    open_ = year_of(now);
  }

  /// Opens a year after the open one, while there are no events.
  void open(std::uint64_t year) { open_ = year; }

  /// Keeps an event of a year after the open one. False, and nothing is done, when it is too far ahead.
  bool push(Event event) {
    const std::uint64_t year = year_of(event.time);
    if (year - open_ > mask_) [[unlikely]] {
      return false;
    }
    std::uint32_t& last = last_block_[year & mask_];
    if (last == none) {
      with_events_.insert(static_cast<std::uint32_t>(year & mask_));
    }
    if (last == none || blocks_[last].size == events_a_block) {
      last = new_block(last);
    }
    Block& block = blocks_[last];
    block.events[block.size++] = event;
    ++size_;
    return true;
  }

  /// Opens the first year with events, of which there must be one, and calls take(event) for each of them.
  template <class Take>
  void open_next(const Take& take) {
    const auto open = static_cast<std::uint32_t>(open_ & mask_);
    const std::uint32_t next = with_events_.next((open + 1) & mask_);
    with_events_.erase(next);
    open_ += (next - open) & mask_;
    std::uint32_t number = last_block_[next];
    last_block_[next] = none;
    while (number != none) {
      Block& block = blocks_[number];
      for (std::uint32_t i = 0; i < block.size; ++i) {
        take(block.events[i]);
      }
      size_ -= block.size;
      const std::uint32_t before = block.before;
      block.before = free_;
      free_ = number;
      number = before;
    }
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  static constexpr std::uint32_t events_a_block = 15;

  struct alignas(64) Block {
    std::uint32_t size = 0;
    std::uint32_t before = none;  // of its year, or of the blocks that are free
    std::array<Event, events_a_block> events;
  };
  static_assert(bytes_an_event == 3 * sizeof(Block) / events_a_block);

  std::uint32_t new_block(std::uint32_t before) {
    std::uint32_t number = free_;
    if (number == none) {
      number = static_cast<std::uint32_t>(blocks_.size());
      blocks_.emplace_back();
    } else {
      free_ = blocks_[number].before;
    }
    blocks_[number].size = 0;
    blocks_[number].before = before;
    return number;
  }

  std::uint32_t mask_;     // number of years less 1
  NumberSet with_events_;  // year y stands at y modulo their number
  std::vector<std::uint32_t> last_block_;
  LargeVector<Block> blocks_;
  std::uint32_t free_ = none;
  unsigned shift_ = 0;
  std::uint64_t open_ = 0;
  std::size_t size_ = 0;
};

}  // namespace marti::sim
