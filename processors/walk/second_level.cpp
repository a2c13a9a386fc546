#include "processors/walk/second_level.h"

namespace marti::processors {

memory::BankConfig banks_of(const MachineConfig& config) {
  memory::BankConfig banks = config.banks;
  if (config.l2.sharing == SecondLevel::shared) {
    banks.cache =
        memory::SharedCacheConfig{second_level_cache(config), config.banks.clock, config.l2.hit_cycles};
  }
  return banks;
}

memory::CacheCounters SecondLevelResult::counters() const {
  memory::CacheCounters sum;
  for (const memory::CacheCounters& cache : caches) {
    sim::merge(sum, cache);
  }
  return sum;
}

PrivateSecondLevel::PrivateSecondLevel(const MachineConfig& config)
    : hit_ticks_(config.clock.cycles(config.l2.hit_cycles)) {
  if (config.l2.sharing == SecondLevel::private_caches) {
    tags_.emplace(second_level_cache(config), config.all_nodes());
    counters_.resize(config.all_nodes());
  }
}

}  // namespace marti::processors
