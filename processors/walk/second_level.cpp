#include "processors/walk/second_level.h"

namespace marti::processors::walk {

memory::BankConfig banks_of(const machine::MachineConfig& config) {
  memory::BankConfig banks = config.banks;
  if (config.l2.sharing == machine::SecondLevel::shared) {
    banks.cache =
        memory::SharedCacheConfig{machine::second_level_cache(config),
                                  config.l2.clock.value_or(config.interconnect.clock), config.l2.hit_cycles};
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

PrivateSecondLevel::PrivateSecondLevel(const machine::MachineConfig& config)
    : hit_ticks_(config.l2.clock.value_or(config.clock).cycles(config.l2.hit_cycles)) {
  if (config.l2.sharing == machine::SecondLevel::private_caches) {
    tags_.emplace(machine::second_level_cache(config), config.all_nodes());
    counters_.resize(config.all_nodes());
  }
}

}  // namespace marti::processors::walk
