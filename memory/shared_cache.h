// A cache before the banks of a shared memory, used by all nodes of a cluster: a second level on the
// memory's side of the interconnect.
//
// Reads look it up in the order in which they arrive. A hit is ready `hit_cycles` after its arrival and
// delays no other access; but a line that its bank is still reading is not ready before the bank has it. A
// miss costs no time here: it goes to its bank at once, and its line is brought in. Writes go through to
// their banks and update a line that the cache holds, so no line is ever stale; they bring no line in and do
// not count as a use of a line.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>

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
  /// Says that the line of the last miss arrives at `ready`.
  void fill(sim::Ticks ready);

  [[nodiscard]] const SharedCacheStatistics& statistics() const { return statistics_; }

 private:
  void forget_arrived(sim::Ticks now);

  unsigned line_shift_;
  sim::Ticks hit_ticks_;
  TagArray tags_;
  SharedCacheStatistics statistics_;
  std::uint32_t missed_ = 0;
  sim::Ticks missed_at_ = 0;
  /// The arrival times of lines brought in lately. Past ones are removed from time to time.
  std::unordered_map<std::uint32_t, sim::Ticks> coming_;
  std::size_t most_coming_ = 64;
};

}  // namespace marti::memory
