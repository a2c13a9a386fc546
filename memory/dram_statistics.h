// What a DRAM channel counts.
#pragma once

#include <array>
#include <cstdint>

#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::memory {

/// Hits, misses and conflicts are told by the state of the bank when the first command of a burst is issued.
struct DramStatistics {
  std::int64_t read_bursts = 0;
  std::int64_t write_bursts = 0;
  std::int64_t forwarded = 0;
  std::int64_t row_hits = 0;
  std::int64_t row_misses = 0;
  std::int64_t row_conflicts = 0;
  std::int64_t activations = 0;
  std::int64_t refreshes = 0;
  std::int64_t bytes = 0;
  std::int64_t data_buses = 0;
  sim::Ticks data_busy = 0;
  sim::Ticks bus_rows = 0;
  sim::Ticks bus_refresh = 0;
  sim::Ticks bus_turn = 0;
  sim::Ticks bus_no_request = 0;
  sim::Ticks refresh_stall = 0;
  sim::Sum queued = 0;

  /// Counts bursts that move their data, each so many bytes in so much time of a data bus.
  void count_moved(bool write, std::int64_t bursts, std::uint32_t burst_bytes, sim::Ticks burst_time) {
    (write ? write_bursts : read_bursts) += bursts;
    bytes += bursts * burst_bytes;
    data_busy = sim::add_ticks(data_busy, sim::multiply_ticks(burst_time, bursts));
  }

  static constexpr auto counters() {
    using S = DramStatistics;
    using C = sim::Counter<S>;
    constexpr auto sum = sim::MergeRule::sum;
    constexpr auto neither = sim::Better::neither;
    return std::array{
        C{"read_bursts", "1", "bursts read", &S::read_bursts},
        C{"write_bursts", "1", "bursts written", &S::write_bursts},
        C{"forwarded", "1", "reads of bytes that waited to be written", &S::forwarded, sum, neither},
        C{"row_hits", "1", "bursts that found their row open", &S::row_hits, sum, sim::Better::higher},
        C{"row_misses", "1", "bursts that found no row of their bank open", &S::row_misses, sum, neither},
        C{"row_conflicts", "1", "bursts that found another row of their bank open", &S::row_conflicts},
        C{"activations", "1", "rows opened", &S::activations},
        C{"refreshes", "1", "refreshes of a rank, up to the last access", &S::refreshes, sum, neither},
        C{"bytes", "byte", "data moved, in whole bursts", &S::bytes},
        C{"data_buses", "1", "data buses: one, or one for each pseudo channel", &S::data_buses, sum, neither},
        C{"data_busy", "ps", "time for which data buses move data", &S::data_busy},
        C{"bus_rows", "ps", "time for which data buses wait for rows to be closed and opened", &S::bus_rows},
        C{"bus_refresh", "ps", "time for which data buses wait for a refresh", &S::bus_refresh},
        C{"bus_turn", "ps",
          "time for which data buses turn between reads and writes, ranks and bank groups: waits for open "
          "rows",
          &S::bus_turn},
        C{"bus_no_request", "ps", "time for which data buses have no request", &S::bus_no_request, sum,
          neither},
        C{"refresh_stall", "ps", "time for which the oldest access waits for a refresh", &S::refresh_stall},
        C{"queued", "ps", "time from the arrival of each access to its last read or write command",
          &S::queued}};
  }
};
static_assert(sim::declares_every_member<DramStatistics>());

}  // namespace marti::memory
