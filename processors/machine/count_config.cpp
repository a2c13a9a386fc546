#include "processors/machine/count_config.h"

#include <string>
#include <string_view>

#include "processors/machine/machine_config.h"
#include "sim/key_error.h"

namespace marti::processors {

std::string_view key_of(const CountConfig& count) {
  return count.miss_classes ? "count.miss_classes" : count.sharing ? "count.sharing" : "count.attribution";
}

void check_counting(const MachineConfig& config) {
  if (!config.count.any()) {
    return;
  }
  const std::string key(key_of(config.count));
  if (config.scheme != Scheme::image) {
    throw sim::KeyError(key, "[count] is for machine.scheme = \"image\" only");
  }
  if (config.build.sharing != Sharing::given) {
    throw sim::KeyError(
        key,
        "[count] is for build.sharing = \"given\" only: nodes that build their tree are not counted in "
        "detail");
  }
  if (config.count.miss_classes && config.cache.organisation == CacheOrganisation::none) {
    throw sim::KeyError(key, "without a cache (cache.organisation) there is nothing to class");
  }
}

}  // namespace marti::processors
