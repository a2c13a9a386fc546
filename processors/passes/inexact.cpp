// Which machines can be replayed in part, or out of order.
#include <string>

#include "processors/replay/replay.h"
#include "sim/key_error.h"

namespace marti::processors {

void check_sampled(const MachineConfig& config) {
  const auto refuse = [](const char* key, const std::string& reason) {
    throw sim::KeyError(key, "a sample of packets is replayed with " + reason + " only");
  };
  if (config.scheme != Scheme::image) {
    refuse("machine.scheme", "machine.scheme = \"image\"");
  }
  if (config.build.sharing != Sharing::given) {
    refuse("build.sharing", "build.sharing = \"given\"");
  }
  if (config.host.assignment != Assignment::dynamic) {
    refuse("host.assignment", "host.assignment = \"dynamic\"");
  }
  if (config.contexts > 1 || config.prefetch.on()) {
    refuse(config.contexts > 1         ? "node.contexts"
           : config.prefetch.next_line ? "prefetch.next_line"
                                       : "prefetch.children",
           "one context (node.contexts) and without prefetching");
  }
  if (config.l2.sharing != SecondLevel::none) {
    refuse("l2.sharing", "one level of caches (l2.sharing = \"none\")");
  }
  if (config.count.any() || config.count.working_set) {
    refuse(config.count.working_set    ? "count.working_set"
           : config.count.miss_classes ? "count.miss_classes"
           : config.count.sharing      ? "count.sharing"
                                       : "count.attribution",
           "nothing counted beside hits and misses ([count])");
  }
}

void check_relaxed(const MachineConfig& config) {
  check_sampled(config);
  if (config.placement == Placement::distributed ||
      (config.interconnect.kind == memory::InterconnectKind::bus &&
       config.interconnect.arbitration != memory::Arbitration::fifo)) {
    throw sim::KeyError(
        config.placement == Placement::distributed ? "database.placement" : "interconnect.arbitration",
        "time may be relaxed only where requests are served first come, first served: not with a distributed "
        "database or a bus granted by priority");
  }
}

}  // namespace marti::processors
