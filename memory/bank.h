// Memory banks: interleaved by line, each serves one access at a time in order of arrival; with or without a
// cache before them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "memory/record_kind.h"
#include "memory/shared_cache.h"
#include "memory/wait_statistics.h"
#include "sim/time.h"

namespace marti::memory {

/// `access_cycles` pass from the start of an access until its data are there; the bank can start the next
/// one `busy_cycles` after the start of the last.
struct BankConfig {
  std::uint32_t count = 4;
  std::uint32_t interleave = 32;  ///< bytes in a row that share a bank; a power of two
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::int64_t access_cycles = 4;
  std::int64_t busy_cycles = 6;
  std::optional<SharedCacheConfig> cache{};  ///< before the banks; std::nullopt: no cache
};

struct BankStatistics {
  std::int64_t accesses = 0;
  sim::Ticks busy = 0;
  WaitStatistics waits;  ///< from an access's arrival to its start

  static constexpr auto counters() {
    using C = sim::Counter<BankStatistics>;
    return std::array{C{"accesses", "1", "reads and writes served", &BankStatistics::accesses},
                      C{"busy", "ps", "busy time of these accesses", &BankStatistics::busy}};
  }
};

/// When one access starts and when its data are ready.
struct BankAccess {
  sim::Ticks start = 0;
  sim::Ticks ready = 0;
};

class Banks {
 public:
  explicit Banks(const BankConfig& config);

  [[nodiscard]] std::uint32_t bank_of(Address address) const {
    const Address unit = address >> interleave_shift_;
    return static_cast<std::uint32_t>((count_ & (count_ - 1)) == 0 ? unit & (count_ - 1) : unit % count_);
  }
  /// A read or write whose address arrives at `arrival`, at the cache if there is one, else at its bank.
  /// Calls must come in order of arrival.
  BankAccess read(Address address, sim::Ticks arrival) {
    return cache_ ? read_cached(address, arrival) : access(bank_of(address), arrival);
  }
  BankAccess write(Address address, sim::Ticks arrival) { return access(bank_of(address), arrival); }

  /// Queues an access that arrives at `arrival` and bypasses the cache. Accesses to one bank must come in
  /// order of arrival.
  BankAccess access(std::uint32_t bank, sim::Ticks arrival) {
    const sim::Ticks start = std::max(arrival, free_at_[bank]);
    free_at_[bank] = sim::add_ticks(start, busy_ticks_);
    BankStatistics& statistics = statistics_[bank];
    ++statistics.accesses;
    statistics.busy = sim::add_ticks(statistics.busy, busy_ticks_);
    statistics.waits.add(start - arrival);
    return {start, sim::add_ticks(start, access_ticks_)};
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] const std::vector<BankStatistics>& statistics() const { return statistics_; }
  /// Statistics of the cache; null without a cache.
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const {
    return cache_ ? &cache_->statistics() : nullptr;
  }

 private:
  BankAccess read_cached(Address address, sim::Ticks arrival);

  std::uint32_t count_;
  std::uint32_t interleave_shift_;
  sim::Ticks access_ticks_;
  sim::Ticks busy_ticks_;
  std::vector<sim::Ticks> free_at_;
  std::vector<BankStatistics> statistics_;
  std::optional<SharedCache> cache_;
};

}  // namespace marti::memory
