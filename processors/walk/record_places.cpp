#include "processors/walk/record_places.h"

#include <algorithm>

#include "memory/set_tags.h"
#include "processors/walk/node_order.h"
#include "sim/key_error.h"

namespace marti::processors {

memory::Layout layout_of(const WorkLog& log, const MachineConfig& config, std::optional<TreePlan>& plan) {
  const memory::RecordCounts counts = {plan ? plan->initial_nodes() : log.topology.nodes.size(),
                                       plan ? plan->initial_entries() : log.topology.entries.size(),
                                       log.primitives,
                                       log.materials,
                                       log.texture_begin.empty() ? 0 : log.texture_begin.back(),
                                       std::uint64_t{log.width} * log.height};
  const memory::Layout layout(config.layout, counts, log.quadrics.size());
  const std::uint32_t unit = config.reference_bytes();
  if (plan) {
    plan->place_behind(layout, unit);
  }
  if (std::max(layout.end(), plan ? plan->end() : 0) / unit >= memory::no_line) {
    throw sim::KeyError("cache.line", "the database has 2^32 or more lines; use longer cache lines");
  }
  return layout;
}

std::vector<std::uint32_t> node_ranks(const WorkLog& log, const MachineConfig& config) {
  return config.layout.node_order == memory::NodeOrder::depth_first ? depth_first_rank(log.topology)
                                                                    : std::vector<std::uint32_t>{};
}

}  // namespace marti::processors
