// A cache before the banks of a shared memory, used by all nodes of a cluster: a second level on the
// memory's side of the interconnect.
//
// Reads look it up in the order in which they arrive. A hit is ready `hit_cycles` after its arrival and
// delays no other access; but a line that its bank is still reading is not ready before the bank has it. A
// miss costs no time here: it goes to its bank at once, and its line is brought in. Where a bank tells the
// end of a read later, hits of such a line wait until it is told. Writes go through to their banks and update
// a line that the cache holds, so no line is ever stale; they bring no line in and do not count as a use of a
// line.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "memory/cache.h"
#include "memory/tag_array.h"
#include "memory/wait_statistics.h"
#include "sim/time.h"

namespace marti::memory {

struct SharedCacheConfig {
  CacheConfig cache;
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::int64_t hit_cycles = 2;
};

struct SharedCacheStatistics {
  CacheCounters lookups;
  WaitStatistics waits;  ///< of hits, for lines that are on their way from a bank
};

class SharedCache {
 public:
  /// Throws UserError when the configuration describes no cache.
  explicit SharedCache(const SharedCacheConfig& config);

  struct Hit {
    sim::Ticks start = 0;
    sim::Ticks ready = 0;
  };
  /// Looks up a read that arrives at `arrival`, in order of arrival. After a miss (std::nullopt) call fill().
  std::optional<Hit> read(Address address, sim::Ticks arrival);
  /// Says that the line of a miss of this address at `arrival` comes at `ready`.
  void fill(Address address, sim::Ticks arrival, sim::Ticks ready);

  /// What a read finds whose bank tells later when a line arrives.
  struct LateLook {
    bool miss = false;
    std::optional<Hit> hit;  ///< nothing after a miss, and for a line whose arrival has not been told
  };
  /// read() for the read of a port that has no other. After a miss call tell() when the arrival is known;
  /// until then reads of the line wait there.
  LateLook read_late(std::uint32_t port, Address address, sim::Ticks arrival);
  /// A read that waited for a line, and its hit.
  struct LateHit {
    std::uint32_t port = 0;
    sim::Ticks arrival = 0;
    Hit hit;
  };
  /// Says that the line of the port's last miss, which read `address`, arrives at `ready`. Returns the reads
  /// that waited for it, oldest first.
  std::vector<LateHit> tell(std::uint32_t port, Address address, sim::Ticks ready);

  [[nodiscard]] const SharedCacheStatistics& statistics() const { return statistics_; }

 private:
  static constexpr std::uint32_t no_port = std::numeric_limits<std::uint32_t>::max();
  static constexpr sim::Ticks not_told = std::numeric_limits<sim::Ticks>::max();
  struct Coming {
    sim::Ticks ready = not_told;
    std::uint32_t port = no_port;  // whose miss brings the line; no_port once `ready` is known
  };
  struct Waiting {
    std::uint32_t port = 0;
    sim::Ticks arrival = 0;
  };

  // Looks a line up and counts it; brings a missing one in. True if it was here or on its way.
  bool look_up(std::uint32_t line);
  // A hit of a line that arrives at `there`.
  Hit hit_at(sim::Ticks arrival, sim::Ticks there);
  // Notes when a line comes, and forgets lines that have come before `now`.
  void note_coming(std::uint32_t line, const Coming& coming, sim::Ticks now);
  [[nodiscard]] std::uint32_t line_of(Address address) const {
    return static_cast<std::uint32_t>(address >> line_shift_);
  }

  unsigned line_shift_;
  sim::Ticks hit_ticks_;
  TagArray tags_;
  SharedCacheStatistics statistics_;
  // Lines brought in lately. Those that have arrived are removed from time to time.
  std::unordered_map<std::uint32_t, Coming> coming_;
  std::size_t most_coming_ = 64;
  std::unordered_map<std::uint32_t, std::vector<Waiting>> waiting_;  // for the line of a port's miss
};

}  // namespace marti::memory
