#include "processors/machine/second_level_config.h"

#include "processors/machine/machine_config.h"
#include "sim/key_error.h"

namespace marti::processors::machine {

memory::CacheConfig second_level_cache(const MachineConfig& config) {
  memory::CacheConfig cache = config.l2.cache;
  cache.line = config.reference_bytes();
  return cache;
}

void check_second_level(const MachineConfig& config) {
  if (config.l2.sharing == SecondLevel::none) {
    return;
  }
  if (config.l2.sharing == SecondLevel::private_caches &&
      config.cache.organisation == CacheOrganisation::none) {
    throw sim::KeyError("l2.sharing",
                        "a private second level needs a first one to stand behind (cache.organisation = "
                        "\"none\")");
  }
  if (config.l2.sharing == SecondLevel::shared) {
    if (config.interconnect.kind == memory::InterconnectKind::ideal) {
      throw sim::KeyError(
          "l2.sharing",
          "an ideal interconnect (interconnect.kind) has no memory behind it that a shared second "
          "level could stand before");
    }
    if (config.placement != Placement::shared || config.scheme == Scheme::space) {
      throw sim::KeyError(
          "l2.sharing",
          "nodes read nothing from a shared memory with database.placement = \"replicated\" or "
          "\"distributed\" or with machine.scheme = \"space\"; use \"private\" or \"none\"");
    }
  }
  (void)sim::KeyError::reported_under("l2.size",
                                      [&] { return memory::shape_of(second_level_cache(config)); });
}

}  // namespace marti::processors::machine
