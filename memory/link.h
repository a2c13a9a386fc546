// A shared link: how long data take on it, and its queue, first come first served.
#pragma once

#include <algorithm>

#include "memory/interconnect.h"

namespace marti::memory {

/// Time of `bytes` on a link of the configured width, in whole beats. Nearly all transactions have the same
/// size, so the last result is kept.
class BeatTime {
 public:
  explicit BeatTime(const InterconnectConfig& config)
      : config_(config), beat_(config.clock.cycles(config.cycles_per_beat)) {}
  [[nodiscard]] sim::Ticks operator()(std::uint32_t bytes) const {
    if (bytes != last_bytes_) {
      last_bytes_ = bytes;
      last_ticks_ = sim::multiply_ticks(beat_, config_.beats(bytes));
    }
    return last_ticks_;
  }

 private:
  InterconnectConfig config_;
  sim::Ticks beat_;
  mutable std::uint32_t last_bytes_ = 0;
  mutable sim::Ticks last_ticks_ = 0;
};

/// One server with a queue. Calls must come in the order of their arrivals.
class Link {
 public:
  /// The time at which a tenure that asks at `arrival` begins.
  [[nodiscard]] sim::Ticks begin(sim::Ticks arrival) const { return std::max(arrival, free_at_); }
  /// Keeps the link until `end`, for the tenure that has begun last.
  void hold_until(sim::Ticks end) { free_at_ = end; }

 private:
  sim::Ticks free_at_ = 0;
};

}  // namespace marti::memory
