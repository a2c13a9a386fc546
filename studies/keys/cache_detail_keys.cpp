#include <limits>

#include "processors/passes/working_set.h"
#include "processors/walk/cache_counting.h"
#include "processors/walk/second_level.h"
#include "sim/config_errors.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

void declare_second_level_keys(sim::Schema& schema) {
  schema.section("l2", "a second level of caches; its line is the first level's");
  schema.choice("l2.sharing", "none", names(processors::machine::second_level_names),
                "none; private: one behind the first-level cache of each node; shared: one for each cluster, "
                "before the "
                "banks of its memory");
  schema.size("l2.size", "256 KiB", {"1 B", "4 GiB"}, "size of each second-level cache");
  schema.integer("l2.ways", 8, {0, std::numeric_limits<std::int32_t>::max()}, "",
                 "lines of a set; 0: fully associative");
  schema.choice("l2.replacement", "lru", names(memory::replacement_names),
                "which line of a full set is replaced");
  schema.integer("l2.seed", 1, {0, std::numeric_limits<std::int64_t>::max()}, "",
                 "seed of random replacement");
  schema.frequency("l2.clock", "0 Hz", {"0 Hz", "1 THz"},
                   "clock of the second level; 0 Hz: private: node.clock; shared: interconnect.clock");
  cycles(schema, "l2.hit_cycles", 4, "cycles of l2.clock of a look-up that hits");
}

void read_second_level(sim::Config& config, processors::machine::MachineConfig& machine) {
  using processors::machine::SecondLevel;
  processors::machine::SecondLevelConfig& l2 = machine.l2;
  l2.sharing = config.choice_as<SecondLevel>("l2.sharing");
  if (l2.sharing == SecondLevel::none) {
    config.mark_unused_reason("l2", "it has no effect with l2.sharing = \"none\"", "l2.sharing");
    return;
  }
  l2.cache.size = static_cast<std::uint64_t>(config.size("l2.size"));
  l2.cache.ways = count(config, "l2.ways");
  l2.cache.replacement = config.choice_as<memory::Replacement>("l2.replacement");
  if (const double hertz = config.frequency("l2.clock"); hertz >= 1.0) {
    l2.clock = sim::Clock::from_hertz(hertz);
  } else if (hertz > 0.0) {
    config.fail("l2.clock", "must be 0 Hz, for the clock of what it stands beside, or at least 1 Hz");
  }
  l2.hit_cycles = config.integer("l2.hit_cycles");
  if (l2.cache.replacement == memory::Replacement::random) {
    l2.cache.seed = static_cast<std::uint64_t>(config.integer("l2.seed"));
  }
  config.mark_unused_reason("l2.seed", "only l2.replacement = \"random\" draws numbers", "l2.replacement");
  sim::with_places(config, [&] { processors::machine::check_second_level(machine); });
}

void declare_count_keys(sim::Schema& schema) {
  schema.section("count",
                 "what is counted about the caches beside hits and misses; it makes runs slower, and changes "
                 "nothing else but the number of simulated events");
  schema.boolean("count.miss_classes", false,
                 "why first-level caches missed: compulsory, capacity, conflict, invalidation");
  schema.boolean("count.sharing", false, "how many nodes of a cluster fetched each line");
  schema.boolean("count.attribution", false,
                 "references, misses and waits by record kind, tree level, ray kind and bounce");
  schema.boolean("count.working_set", false,
                 "what first-level LRU caches of every size, and of all ways, would have missed, from one "
                 "pass over the references of each node");
}

void read_count(sim::Config& config, processors::machine::MachineConfig& machine) {
  machine.count = {config.boolean("count.miss_classes"), config.boolean("count.sharing"),
                   config.boolean("count.attribution"), config.boolean("count.working_set")};
  sim::with_places(config, [&] {
    processors::machine::check_counting(machine);
    processors::passes::check_working_set(machine);
  });
}

}  // namespace marti::studies::keys
