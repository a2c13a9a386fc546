// Which machines can be replayed in part, or out of order.
#include <string>

#include "processors/replay.h"
#include "sim/error.h"

namespace marti::processors {

void check_sampled(const MachineConfig& config) {
  const auto refuse = [](const std::string& reason) {
    throw sim::UserError("a sample of packets is replayed with " + reason + " only");
  };
  if (config.scheme != Scheme::image) {
    refuse("machine.scheme = \"image\"");
  }
  if (config.build.sharing != Sharing::given) {
    refuse("build.sharing = \"given\"");
  }
  if (config.host.assignment != Assignment::dynamic) {
    refuse("host.assignment = \"dynamic\"");
  }
  if (config.contexts > 1 || config.prefetch.on()) {
    refuse("one context (node.contexts) and without prefetching");
  }
  if (config.l2.sharing != SecondLevel::none) {
    refuse("one level of caches (l2.sharing = \"none\")");
  }
  if (config.count.any() || config.count.working_set) {
    refuse("nothing counted beside hits and misses ([count])");
  }
}

void check_relaxed(const MachineConfig& config) {
  check_sampled(config);
  if (config.placement == Placement::distributed ||
      (config.interconnect.kind == memory::InterconnectKind::bus &&
       config.interconnect.arbitration != memory::Arbitration::fifo)) {
    throw sim::UserError(
        "time may be relaxed only where requests are served first come, first served: not with a distributed "
        "database or a bus granted by priority");
  }
}

}  // namespace marti::processors
