#include "memory/bank.h"

#include <algorithm>
#include <bit>

#include "sim/error.h"

namespace marti::memory {

Banks::Banks(const BankConfig& config)
    : count_(config.count),
      interleave_shift_(static_cast<std::uint32_t>(std::countr_zero(config.interleave))),
      access_ticks_(config.clock.cycles(config.access_cycles)),
      busy_ticks_(config.clock.cycles(config.busy_cycles)),
      free_at_(config.count),
      statistics_(config.count) {
  if (config.count == 0 || !std::has_single_bit(config.interleave)) {
    throw sim::UserError("memory needs at least one bank and an interleave that is a power of two");
  }
  if (config.cache) {
    cache_.emplace(*config.cache);
  }
}

BankAccess Banks::read_cached(Address address, sim::Ticks arrival) {
  if (const std::optional<SharedCache::Hit> hit = cache_->read(address, arrival)) {
    return {hit->start, hit->ready};
  }
  const BankAccess filled = access(bank_of(address), arrival);
  cache_->fill(filled.ready);
  return filled;
}

BankAccess Banks::access(std::uint32_t bank, sim::Ticks arrival) {
  const sim::Ticks start = std::max(arrival, free_at_[bank]);
  free_at_[bank] = sim::add_ticks(start, busy_ticks_);
  BankStatistics& statistics = statistics_[bank];
  ++statistics.accesses;
  statistics.busy = sim::add_ticks(statistics.busy, busy_ticks_);
  statistics.waits.add(start - arrival);
  return {start, sim::add_ticks(start, access_ticks_)};
}

}  // namespace marti::memory
