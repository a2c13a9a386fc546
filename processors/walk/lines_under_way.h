// What a node with contexts or prefetches knows of its cache's lines beside their tags: which of them are
// still on their way from memory, and which were prefetched and not asked for yet.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "sim/time.h"

namespace marti::processors {

/// A time that has not come and is not known.
inline constexpr sim::Ticks never = INT64_MAX;

/// Of one node. Times given must not decrease.
class LinesUnderWay {
 public:
  /// A line of one of the node's caches.
  using Key = std::uint64_t;
  static constexpr std::uint32_t none = 0xffffffffU;

  /// The transaction that brings the line, when its data have not come by `time`; else `none`.
  [[nodiscard]] std::uint32_t find(Key key, sim::Ticks time) {
    std::size_t at = 0;
    while (at < flights_.size()) {
      if (flights_[at].done <= time) {
        flights_[at] = flights_.back();
        flights_.pop_back();
      } else if (flights_[at].key == key) {
        return flights_[at].slot;
      } else {
        ++at;
      }
    }
    return none;
  }
  /// Transaction `slot`, which has no other line under way, asks for the line at `time`. Should the line have
  /// been on its way already and pushed out since, the new transaction is the one that brings it.
  void begin(Key key, std::uint32_t slot, sim::Ticks time) {
    std::erase_if(flights_, [&](const Flight& flight) { return flight.done <= time || flight.key == key; });
    flights_.push_back({key, never, slot});
  }
  /// The data of transaction `slot` come at `done`.
  void arrives(std::uint32_t slot, sim::Ticks done) {
    for (Flight& flight : flights_) {
      if (flight.slot == slot && flight.done == never) {
        flight.done = done;
      }
    }
  }

  /// A line is prefetched. True when it had been before, and was pushed out without a reference.
  bool mark(Key key) { return !unasked_.insert(key).second; }
  /// A line is asked for. True when it was prefetched and not asked for since.
  bool unmark(Key key) { return !unasked_.empty() && unasked_.erase(key) != 0; }
  /// Prefetched lines that nobody has asked for.
  [[nodiscard]] std::size_t unasked() const { return unasked_.size(); }

 private:
  struct Flight {
    Key key = 0;
    sim::Ticks done = never;
    std::uint32_t slot = 0;
  };
  std::vector<Flight> flights_;  // few, and those that have arrived go at the next look
  std::unordered_set<Key> unasked_;
};

}  // namespace marti::processors
