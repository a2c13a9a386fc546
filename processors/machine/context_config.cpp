#include "processors/machine/context_config.h"

#include "processors/machine/machine_config.h"
#include "sim/key_error.h"

namespace marti::processors {

void check_contexts(const MachineConfig& config) {
  if (config.contexts == 0 || config.contexts > most_contexts) {
    throw sim::KeyError("node.contexts", "a node has 1 to " + std::to_string(most_contexts) + " contexts");
  }
  if (config.switch_cycles < 0) {
    throw sim::KeyError("node.switch_cycles", "must not be negative");
  }
  const bool prefetch = config.prefetch.on();
  if (config.contexts == 1 && !prefetch) {
    return;
  }
  const std::string prefetch_key = config.prefetch.next_line ? "prefetch.next_line" : "prefetch.children";
  const std::string key = config.contexts > 1 ? "node.contexts" : prefetch_key;
  if (config.scheme != Scheme::image) {
    throw sim::KeyError(key, "only the image scheme's nodes have contexts and prefetch");
  }
  if (config.build.sharing != Sharing::given) {
    throw sim::KeyError(key,
                        "nodes that build the tree during the frame have one context and do not prefetch; "
                        "build.sharing must be \"given\"");
  }
  if (prefetch && (config.prefetch.outstanding == 0 || config.prefetch.outstanding > most_contexts)) {
    throw sim::KeyError("prefetch.outstanding",
                        "a node has 1 to " + std::to_string(most_contexts) + " prefetches under way");
  }
  if (prefetch && config.cache.organisation == CacheOrganisation::none) {
    throw sim::KeyError(prefetch_key, "without a cache there is nowhere to put a line");
  }
  if (config.placement == Placement::distributed) {
    throw sim::KeyError(key,
                        "nodes whose memories others read (database.placement = \"distributed\") have "
                        "one context and do not prefetch");
  }
  if (config.l2.sharing == SecondLevel::private_caches) {
    throw sim::KeyError(key,
                        "a node with a second-level cache of its own (l2.sharing = \"private\") has one "
                        "context and does not prefetch");
  }
  if (config.count.any()) {
    throw sim::KeyError(key, "[count] is for nodes with one context that do not prefetch");
  }
  if (prefetch && config.placement != Placement::shared) {
    throw sim::KeyError(prefetch_key, "only lines of a shared database are prefetched");
  }
  if (std::uint64_t{config.all_nodes()} * config.ports_of_node() > most_ports) {
    throw sim::KeyError("node.contexts", "nodes with more than 2^28 contexts and prefetches in all");
  }
}

void check_prefetch(const PrefetchConfig& config, accel::Traversal traversal) {
  if (config.children && (traversal == accel::Traversal::grid || traversal == accel::Traversal::none)) {
    throw sim::KeyError("prefetch.children", "only an octree or a bsp tree has branches with children");
  }
}

}  // namespace marti::processors
