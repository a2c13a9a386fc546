#include "processors/machine/count_config.h"

#include "processors/machine/machine_config.h"
#include "sim/key_error.h"

namespace marti::processors::machine {

std::string_view key_of(const CountConfig& count) {
  return count.miss_classes ? "count.miss_classes" : count.sharing ? "count.sharing" : "count.attribution";
}

void check_counting(const MachineConfig& config) {
  if (config.count.miss_classes && config.cache.organisation == CacheOrganisation::none) {
    throw sim::KeyError("count.miss_classes",
                        "without a cache (cache.organisation) there is nothing to class");
  }
  if (config.count.miss_classes && config.reference_bytes() != config.cache.cache.line) {
    throw sim::KeyError(
        "count.miss_classes",
        "the classes are of misses of whole lines, and with cache.sector a part of a line misses "
        "by itself; leave cache.sector out");
  }
}

}  // namespace marti::processors::machine
