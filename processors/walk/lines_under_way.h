// What a node with contexts or prefetches keeps of its cache's lines beside their tags: which of them are
// still on their way from memory, and which were prefetched and have not been referenced yet.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "sim/time.h"

namespace marti::processors::walk {

/// The arrival time of data that have not arrived and whose time is not known.
inline constexpr sim::Ticks never = INT64_MAX;

/// The lines of one node. Times passed to it must not decrease.
class LinesUnderWay {
 public:
  /// A line of one of the node's caches: the number of the cache, then in the lower 32 bits that of the line.
  using Key = std::uint64_t;
  static constexpr std::uint32_t none = 0xffffffffU;

  /// The transaction that brings the line, when its data have not arrived by `time`; else `none`.
  [[nodiscard]] std::uint32_t find(Key key, sim::Ticks time) {
    return find_if(time, [key](Key other) { return other == key; });
  }
  /// As find(), for whichever of the node's caches the line is fetched.
  [[nodiscard]] std::uint32_t find_in_any(std::uint32_t line, sim::Ticks time) {
    return find_if(time, [line](Key other) { return static_cast<std::uint32_t>(other) == line; });
  }
  /// Transaction `slot`, which has no other line under way, asks for the line at `time`. If an
  /// earlier transaction for the line is under way (the line was pushed out since), this one replaces it.
  void begin(Key key, std::uint32_t slot, sim::Ticks time) {
    std::erase_if(flights_, [&](const Flight& flight) { return flight.done <= time || flight.key == key; });
    flights_.push_back({key, never, slot});
  }
  /// The data of transaction `slot` arrive at `done`.
  void arrives(std::uint32_t slot, sim::Ticks done) {
    for (Flight& flight : flights_) {
      if (flight.slot == slot && flight.done == never) {
        flight.done = done;
      }
    }
  }

  /// Notes that a line is prefetched. True when it was prefetched before and pushed out without a reference.
  bool mark(Key key) { return !unasked_.insert(key).second; }
  /// Notes that a line is referenced. True when it was prefetched and not referenced since.
  bool unmark(Key key) { return !unasked_.empty() && unasked_.erase(key) != 0; }
  /// Number of prefetched lines that have not been referenced.
  [[nodiscard]] std::size_t unasked() const { return unasked_.size(); }

 private:
  struct Flight {
    Key key = 0;
    sim::Ticks done = never;
    std::uint32_t slot = 0;
  };

  template <class Matches>
  std::uint32_t find_if(sim::Ticks time, const Matches& matches) {
    std::size_t at = 0;
    while (at < flights_.size()) {
      if (flights_[at].done <= time) {
        flights_[at] = flights_.back();
        flights_.pop_back();
      } else if (matches(flights_[at].key)) {
        return flights_[at].slot;
      } else {
        ++at;
      }
    }
    return none;
  }

  std::vector<Flight> flights_;  // few; arrived ones are removed at the next look-up
  std::unordered_set<Key> unasked_;
};

}  // namespace marti::processors::walk
