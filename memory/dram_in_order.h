// A DRAM channel that serves its accesses first come, first served.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/dram_buses.h"
#include "memory/dram_device.h"
#include "memory/dram_statistics.h"

namespace marti::memory {

/// One access to a channel: bursts in consecutive columns of one row.
struct DramRequest {
  DramPlace place;
  std::int64_t bursts = 1;
  bool write = false;
  DramCycle arrival = 0;
};

/// When an access's first command is issued, and when its last data have moved.
struct DramService {
  DramCycle first = 0;
  DramCycle end = 0;
};

/// Reads and writes move their data in the order in which they arrive. A burst closes and opens rows once the
/// one before it has opened its row, which may still wait for its data, or, where that row was open already,
/// has had its read or write command. An access that arrives in a cycle has its first command in the next one
/// at the earliest. When a refresh is due, bursts that have opened their rows end first, then rank after rank
/// closes its rows and is refreshed. One command is issued in a cycle, and none keeps the bus from a read or
/// write of an older burst.
///
/// No access moves the commands of one that arrived before it, so the whole course of an access is known when
/// it arrives.
class DramInOrder {
 public:
  explicit DramInOrder(const DramConfig& config);

  /// Serves the next access; arrivals must not decrease.
  DramService serve(const DramRequest& request);

  /// What was counted, for a frame that ends at `end`.
  [[nodiscard]] DramStatistics statistics(sim::Ticks end) const {
    DramStatistics all = statistics_;
    buses_.count(all, end);
    return all;
  }

 private:
  // Opens the row of an access and issues the command of its first or next burst; returns the cycle of the
  // first of its commands.
  DramCycle burst(const DramRequest& request, bool last);
  // The first cycle from `cycle` on in which a command of `length` keeps the bus from no older access.
  [[nodiscard]] DramCycle free_slot(DramCycle cycle, DramCycle length) const;
  // burst(), command by command: for bursts between whose commands a refresh or an older access's read or
  // write may come. No command comes before `from`.
  DramCycle burst_by_commands(const DramRequest& request, bool last, DramCycle from);
  // Does the refreshes that are due before a command at `cycle`; returns from when on the burst's commands
  // can be issued, not before `from`.
  DramCycle refresh_before(const DramRequest& request, DramCycle cycle, DramCycle from);
  // Notes the cycle of a burst's read or write; `opened`: the burst has opened its row.
  void end_burst(const DramRequest& request, DramCycle column, bool opened);
  // Does the refreshes that are due up to `cycle`.
  void refresh(DramCycle cycle);

  DramCycle refi_;
  DramCycle rfc_;
  sim::Ticks period_;
  sim::Ticks burst_time_;
  std::uint32_t ranks_;
  std::uint32_t burst_bytes_;
  DramCycle column_cycles_;  // that a read or write has its command bus
  bool two_command_buses_;
  bool close_;
  DramDevice device_;
  DramBuses buses_;
  DramStatistics statistics_;
  DramCycle prepared_ = 0;      // from when on the next access may close and open rows
  DramCycle last_column_ = -1;  // cycle of the last read or write
  // Cycle of the last precharge after which its burst waited, be it for its activation or for a refresh.
  DramCycle last_precharge_ = 0;
  DramCycle refresh_due_;
  DramCycle last_refresh_ = 0;
  // Cycles of reads and writes from `prepared_` on; empty where these have a command bus of their own.
  std::vector<DramCycle> columns_;
};

}  // namespace marti::memory
