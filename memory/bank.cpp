#include "memory/bank.h"

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

}  // namespace marti::memory
