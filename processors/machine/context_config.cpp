#include "processors/machine/context_config.h"

#include "processors/machine/combinations.h"
#include "sim/key_error.h"

namespace marti::processors::machine {

void check_contexts(const MachineConfig& config) {
  if (config.contexts == 0 || config.contexts > most_contexts) {
    throw sim::KeyError("node.contexts", "a node has 1 to " + std::to_string(most_contexts) + " contexts");
  }
  if (config.switch_cycles < 0) {
    throw sim::KeyError("node.switch_cycles", "must not be negative");
  }
  if (config.prefetch.on()) {
    const std::string key(key_of(config, Feature::prefetch));
    if (config.prefetch.outstanding == 0 || config.prefetch.outstanding > most_contexts) {
      throw sim::KeyError("prefetch.outstanding",
                          "a node has 1 to " + std::to_string(most_contexts) + " prefetches under way");
    }
    if (config.cache.organisation == CacheOrganisation::none) {
      throw sim::KeyError(key, "without a cache there is nowhere to put a line");
    }
    if (config.placement == Placement::replicated) {
      throw sim::KeyError(key, "a node whose own memory has the whole database does not prefetch");
    }
  }
  if (config.kind == NodeKind::core &&
      std::uint64_t{config.all_nodes()} * config.ports_of_node() > most_ports) {
    throw sim::KeyError("node.contexts", "nodes with more than 2^28 contexts and prefetches in all");
  }
}

void check_prefetch(const PrefetchConfig& config, accel::Traversal traversal) {
  if (config.children && (traversal == accel::Traversal::grid || traversal == accel::Traversal::none)) {
    throw sim::KeyError("prefetch.children",
                        "only an octree, a bsp tree or a bvh has branches with children");
  }
  if (config.stack > 0 && !accel::walks_bvh(traversal)) {
    throw sim::KeyError("prefetch.stack", "only the walk of a bvh keeps entries that wait; set it to 0");
  }
}

}  // namespace marti::processors::machine
