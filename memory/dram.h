// A memory of DRAM channels that serve first come, first served, in the simulator's time.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "memory/dram_in_order.h"
#include "memory/dram_mapping.h"
#include "sim/divider.h"
#include "sim/time.h"

namespace marti::memory {

/// Times of the DRAM's clock in ticks, and back.
class DramClock {
 public:
  explicit DramClock(const DramConfig& config)
      : period_(config.period), steps_(config.steps()), divide_(static_cast<std::uint64_t>(config.period)) {}
  /// The first cycle that does not begin before `time`, in steps.
  [[nodiscard]] DramCycle cycle_at(sim::Ticks time) const {
    if (time > latest) {
      sim::fail_time_overflow();
    }
    return static_cast<DramCycle>(divide_(static_cast<std::uint64_t>(time + period_ - 1))) * steps_;
  }
  /// The beginning of the last cycle before a step.
  [[nodiscard]] sim::Ticks cycle_before(DramCycle step) const { return ticks((step - 1) / steps_ * steps_); }
  /// The beginning of a step, in whole ticks.
  [[nodiscard]] sim::Ticks ticks(DramCycle step) const { return sim::multiply_ticks(period_, step) / steps_; }

 private:
  // Leaves room for sums of times of commands, and keeps numbers below the 2^62 that a Divider takes.
  static constexpr sim::Ticks latest = std::numeric_limits<sim::Ticks>::max() / 4;

  sim::Ticks period_;
  DramCycle steps_;
  sim::Divider divide_;
};

class Dram {
 public:
  explicit Dram(const DramConfig& config);

  struct Times {
    std::uint32_t channel = 0;
    sim::Ticks start = 0;  ///< when the controller takes it up, a cycle before its first command
    sim::Ticks ready = 0;  ///< when all its data have moved
    sim::Ticks data = 0;   ///< for which it has the data bus
  };
  /// An access whose address arrives at `arrival`; arrivals must not decrease. It moves whole bursts, all of
  /// the row of its first byte.
  Times access(Address address, std::uint32_t bytes, bool write, sim::Ticks arrival);

  [[nodiscard]] std::uint32_t channel_of(Address address) const { return mapping_.channel(address); }
  [[nodiscard]] std::vector<DramStatistics> statistics(sim::Ticks end) const;

 private:
  DramClock clock_;
  DramMapping mapping_;
  std::uint32_t burst_bytes_;
  sim::Ticks burst_ticks_;
  std::vector<DramInOrder> channels_;
};

/// The bursts that hold the bytes from `address` on; `burst`: bytes of one, a power of two.
[[nodiscard]] inline std::int64_t bursts_of(Address address, std::uint32_t bytes, std::uint32_t burst) {
  const Address from = address & (burst - 1U);
  return static_cast<std::int64_t>((from + bytes + burst - 1U) >>
                                   static_cast<unsigned>(std::countr_zero(burst)));
}

/// The time of a read of `bytes` that meets no other access, in a bank whose row is closed.
[[nodiscard]] sim::Ticks unloaded_dram_read(const DramConfig& config, std::uint32_t bytes);

}  // namespace marti::memory
