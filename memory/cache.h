// One cache on its own, for programs that need the cache model without the rest of the simulator.
#pragma once

#include <array>
#include <cstdint>

#include "memory/cache_config.h"
#include "memory/record_kind.h"
#include "memory/tag_array.h"
#include "sim/statistics.h"

namespace marti::memory {

/// Hits and misses count lines touched: an access that spans two lines is two references.
struct CacheCounters {
  std::int64_t hits = 0;
  std::int64_t misses = 0;

  [[nodiscard]] std::int64_t references() const { return hits + misses; }

  static constexpr auto counters() {
    using C = sim::Counter<CacheCounters>;
    return std::array{
        C{"hits", "1", "lines found", &CacheCounters::hits, sim::MergeRule::sum, sim::Better::higher},
        C{"misses", "1", "lines brought in", &CacheCounters::misses}};
  }
};
static_assert(sim::declares_every_member<CacheCounters>());

/// A cache of tags; the same model as in the simulated nodes.
class Cache {
 public:
  /// Throws UserError when no cache can have this configuration.
  explicit Cache(const CacheConfig& config);

  /// Reads `bytes` (at least 1) from `address`, line by line; returns the number of lines that missed.
  /// Addresses reach up to 2^32 - 1 lines; beyond that it throws UserError.
  std::int64_t read(Address address, std::uint64_t bytes);

  /// Removes the lines that hold any of these bytes, as after a write by another node; returns how many lines
  /// were removed. Counts nothing. Throws as read() does.
  std::int64_t invalidate(Address address, std::uint64_t bytes);

  [[nodiscard]] const CacheCounters& counters() const { return counters_; }
  [[nodiscard]] const CacheShape& shape() const { return shape_; }

 private:
  struct Lines {
    Address first;
    Address last;
  };
  [[nodiscard]] Lines lines_of(Address address, std::uint64_t bytes) const;

  CacheShape shape_;
  CacheCounters counters_;
  TagArray tags_;
};

}  // namespace marti::memory
