#include "memory/bank.h"

#include <bit>

#include "memory/dram.h"
#include "sim/error.h"

namespace marti::memory {

Banks::Banks(const BankConfig& config)
    : count_(config.banks()),
      interleave_shift_(static_cast<std::uint32_t>(std::countr_zero(config.interleave))),
      access_ticks_(config.clock.cycles(config.access_cycles)),
      busy_ticks_(config.clock.cycles(config.busy_cycles)),
      free_at_(count_),
      statistics_(count_),
      dram_config_(config.dram),
      fixed_only_(!config.cache && !config.dram) {
  if (config.count == 0 || !std::has_single_bit(config.interleave)) {
    throw sim::UserError("memory needs at least one bank and an interleave that is a power of two");
  }
  if (config.cache) {
    cache_.emplace(*config.cache);
  }
  if (config.dram) {
    channels_ = std::make_unique<DramMapping>(*config.dram);
  }
  if (config.dram && config.dram->policy == DramPolicy::fcfs) {
    dram_ = std::make_unique<Dram>(*config.dram);
  }
}

Banks::~Banks() = default;

std::uint32_t Banks::channel_of(Address address) const { return channels_->channel(address); }

std::vector<DramStatistics> Banks::dram_statistics(sim::Ticks end) const {
  return dram_ ? dram_->statistics(end) : std::vector<DramStatistics>();
}

BankAccess Banks::read_otherwise(Address address, std::uint32_t bytes, sim::Ticks arrival) {
  if (cache_) {
    if (const std::optional<SharedCache::Hit> hit = cache_->read(address, arrival)) {
      return {hit->start, hit->ready};
    }
  }
  const BankAccess read =
      dram_ ? access_dram(address, bytes, false, arrival) : access(bank_of(address), arrival);
  if (cache_) {
    cache_->fill(address, arrival, read.ready);
  }
  return read;
}

BankAccess Banks::access_dram(Address address, std::uint32_t bytes, bool write, sim::Ticks arrival) {
  const Dram::Times times = dram_->access(address, bytes, write, arrival);
  statistics_[times.channel].add(times.data, times.start - arrival);
  return {times.start, times.ready};
}

sim::Ticks Banks::unloaded_read(std::uint32_t bytes) const {
  return dram_config_ ? unloaded_dram_read(*dram_config_, bytes) : access_ticks_;
}

}  // namespace marti::memory
