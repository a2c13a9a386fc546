// Memory banks: interleaved by line, each serves one access at a time in order of arrival; or DRAM channels
// in their place. With or without a cache before them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "memory/dram_config.h"
#include "memory/dram_statistics.h"
#include "memory/record_kind.h"
#include "memory/shared_cache.h"
#include "memory/wait_statistics.h"
#include "sim/time.h"

namespace marti::memory {

class Dram;
class DramMapping;

/// Without `dram`: `access_cycles` pass from the start of an access until its data are there; the bank can
/// start the next one `busy_cycles` after the start of the last.
struct BankConfig {
  std::uint32_t count = 4;
  std::uint32_t interleave = 32;  ///< bytes in a row that share a bank; a power of two
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::int64_t access_cycles = 4;
  std::int64_t busy_cycles = 6;
  std::optional<SharedCacheConfig> cache{};  ///< before the banks; std::nullopt: no cache
  std::optional<DramConfig> dram{};          ///< a DRAM memory instead: each of its channels is as a bank

  [[nodiscard]] std::uint32_t banks() const { return dram ? dram->channels : count; }
};

/// Of a DRAM channel: busy is the time of its data bus, and a wait ends when the controller takes an access
/// up.
struct BankStatistics {
  std::int64_t accesses = 0;
  sim::Ticks busy = 0;
  WaitStatistics waits;  ///< from an access's arrival to its start

  [[gnu::always_inline]] void add(sim::Ticks busy_for, sim::Ticks waited) {
    ++accesses;
    busy = sim::add_ticks(busy, busy_for);
    waits.add(waited);
  }

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
  Banks(const Banks&) = delete;
  Banks& operator=(const Banks&) = delete;
  Banks(Banks&&) = delete;
  Banks& operator=(Banks&&) = delete;
  ~Banks();

  [[nodiscard]] std::uint32_t bank_of(Address address) const {
    return channels_ ? channel_of(address) : fixed_bank_of(address);
  }
  /// A read or write whose address arrives at `arrival`, at the cache if there is one, else at its bank.
  /// Calls must come in order of arrival.
  [[gnu::always_inline]] BankAccess read(Address address, std::uint32_t bytes, sim::Ticks arrival) {
    return fixed_only_ ? access(fixed_bank_of(address), arrival) : read_otherwise(address, bytes, arrival);
  }
  BankAccess write(Address address, std::uint32_t bytes, sim::Ticks arrival) {
    return dram_ ? access_dram(address, bytes, true, arrival) : access(bank_of(address), arrival);
  }
  /// The time of a read that waits for nothing and that no cache serves; DRAM: of a row that is closed.
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const;

  /// Queues an access that arrives at `arrival` and bypasses the cache. Accesses to one bank must come in
  /// order of arrival.
  [[gnu::always_inline]] BankAccess access(std::uint32_t bank, sim::Ticks arrival) {
    const sim::Ticks start = std::max(arrival, free_at_[bank]);
    free_at_[bank] = sim::add_ticks(start, busy_ticks_);
    statistics_[bank].add(busy_ticks_, start - arrival);
    return {start, sim::add_ticks(start, access_ticks_)};
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] const std::vector<BankStatistics>& statistics() const { return statistics_; }
  /// Statistics of each DRAM channel, for a frame that ends at `end`; empty for a memory of fixed banks.
  [[nodiscard]] std::vector<DramStatistics> dram_statistics(sim::Ticks end) const;
  /// The cache before the banks; null without one.
  [[nodiscard]] SharedCache* cache() { return cache_ ? &*cache_ : nullptr; }
  /// Statistics of the cache; null without a cache.
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const {
    return cache_ ? &cache_->statistics() : nullptr;
  }

 private:
  [[nodiscard]] std::uint32_t channel_of(Address address) const;
  // Without DRAM.
  [[nodiscard]] [[gnu::always_inline]] std::uint32_t fixed_bank_of(Address address) const {
    const Address unit = address >> interleave_shift_;
    return static_cast<std::uint32_t>((count_ & (count_ - 1)) == 0 ? unit & (count_ - 1) : unit % count_);
  }
  BankAccess read_otherwise(Address address, std::uint32_t bytes, sim::Ticks arrival);
  BankAccess access_dram(Address address, std::uint32_t bytes, bool write, sim::Ticks arrival);

  std::uint32_t count_;
  std::uint32_t interleave_shift_;
  sim::Ticks access_ticks_;
  sim::Ticks busy_ticks_;
  std::vector<sim::Ticks> free_at_;
  std::vector<BankStatistics> statistics_;
  std::optional<SharedCache> cache_;
  std::unique_ptr<DramMapping> channels_;  // where the banks are DRAM channels
  std::unique_ptr<Dram> dram_;             // where these serve first come, first served
  std::optional<DramConfig> dram_config_;
  bool fixed_only_;  // neither a cache nor DRAM
};

}  // namespace marti::memory
