// What the data buses of a DRAM channel do at every time of a frame.
#pragma once

#include <vector>

#include "memory/dram_device.h"
#include "memory/dram_statistics.h"

namespace marti::memory {

/// The rule. A data bus that does not move data is paused. A pause ends with a burst, whose command comes
/// some cycles, its latency, before its data. Each cycle of the pause is due to what the channel was doing so
/// many cycles earlier, which is the first of these that holds in that cycle:
///
///   1. no request: no burst had arrived that moves its data on this bus after the pause;
///   2. refresh: a refresh of the burst's rank was due or under way, and began before the burst's command;
///   3. rows: the burst had not arrived yet, while others waited, or its row was not open for its command;
///   4. turn-around: its row was open. The bus turns between reads and writes or between ranks, the data
///      clock is started, or the least times between the commands of a bank group, of two stacks or on the
///      command bus hold the burst up.
///
/// What comes after the last data is no request, up to the end of the frame. With the time that moves data
/// the four add up to the frame time of each bus.
///
/// Reads and writes are issued at the beginning of a cycle. Where a cycle has two steps, what happens in its
/// middle therefore counts from the next cycle on, and each part is of whole cycles.
class DramBuses {
 public:
  explicit DramBuses(const DramConfig& config);

  /// A burst gets its read or write.
  struct Burst {
    std::uint32_t rank = 0;
    DramCycle arrival = 0;  ///< of the burst
    /// The earliest arrival of those that wait for the same bus, of itself at the latest.
    DramCycle asked = 0;
    DramCycle open = 0;     ///< from when on its row is open for its command
    DramCycle command = 0;  ///< its read or write, not a command before it that starts the data clock
    DramCycle end = 0;      ///< of its data
  };
  /// Commands come in the order of their cycles.
  void moved(const Burst& burst) {
    Bus& bus = buses_[bus_of(burst.rank)];
    const DramCycle data = burst.end - length_;
    if (data > bus.free) {
      pause(bus, burst, data);
    }
    bus.free = burst.end;
  }
  /// A refresh of a rank that was due at `due`; at `end` the rank can be activated again.
  void refreshed(std::uint32_t rank, DramCycle due, DramCycle end) { refreshes_[rank] = {due, end}; }

  [[nodiscard]] std::uint32_t bus_of(std::uint32_t rank) const { return buses_.size() == 1 ? 0 : rank; }

  /// Completes the counts of a channel whose frame ends at `end`.
  void count(DramStatistics& statistics, sim::Ticks end) const;

 private:
  // Times in steps, all of whole cycles.
  struct Bus {
    DramCycle free = 0;  // the end of the last data
    DramCycle no_request = 0;
    DramCycle refresh = 0;
    DramCycle rows = 0;
    DramCycle turn = 0;
  };
  struct Refresh {
    DramCycle due = 0;
    DramCycle end = 0;
  };

  // The first step from `step` on that begins a cycle.
  [[nodiscard]] DramCycle whole(DramCycle step) const { return steps_ == 1 ? step : step + (step & 1); }
  void pause(Bus& bus, const Burst& burst, DramCycle data) const;

  DramCycle steps_;  // of a cycle
  sim::Ticks period_;
  DramCycle length_;  // of a burst's data
  std::vector<Bus> buses_;
  std::vector<Refresh> refreshes_;  // the last one of each rank
};

}  // namespace marti::memory
