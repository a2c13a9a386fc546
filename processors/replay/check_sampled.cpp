// Which machines can be replayed in part, or out of order.
#include <string>
#include <string_view>

#include "processors/machine/combinations.h"
#include "processors/replay/replay.h"
#include "sim/key_error.h"

namespace marti::processors::replay {

void check_sampled(const machine::MachineConfig& config) {
  const auto refuse = [](std::string_view key, const std::string& reason) {
    throw sim::KeyError(std::string(key), "a sample of packets is replayed with " + reason + " only");
  };
  if (config.scheme != machine::Scheme::image) {
    refuse("machine.scheme", "machine.scheme = \"image\"");
  }
  if (config.build.sharing != machine::Sharing::given) {
    refuse("build.sharing", "build.sharing = \"given\"");
  }
  if (config.host.assignment != machine::Assignment::dynamic) {
    refuse("host.assignment", "host.assignment = \"dynamic\"");
  }
  for (const machine::Feature feature : {machine::Feature::contexts, machine::Feature::prefetch}) {
    if (machine::has(config, feature)) {
      refuse(machine::key_of(config, feature), "one context (node.contexts) and without prefetching");
    }
  }
  if (config.kind == machine::NodeKind::simt) {
    refuse("node.kind", "node.kind = \"core\"");
  }
  if (config.l2.sharing != machine::SecondLevel::none) {
    refuse("l2.sharing", "one level of caches (l2.sharing = \"none\")");
  }
  if (config.count.any() || config.count.working_set) {
    refuse(config.count.working_set ? "count.working_set" : machine::key_of(config.count),
           "nothing counted beside hits and misses ([count])");
  }
}

}  // namespace marti::processors::replay
