#include "processors/walk/record_places.h"

#include <algorithm>
#include <utility>

#include "memory/set_tags.h"
#include "processors/walk/node_order.h"
#include "sim/key_error.h"
#include "sim/round_up.h"

namespace marti::processors::walk {

std::uint64_t node_records(const program::WorkLog& log) {
  const std::vector<accel::TopologyNode>& nodes = log.topology.nodes;
  if (!accel::walks_bvh(log.traversal)) {
    return nodes.size();
  }
  return static_cast<std::uint64_t>(
      std::count_if(nodes.begin(), nodes.end(),
                    [](const accel::TopologyNode& node) { return !node.leaf && !node.instance; }));
}

std::uint64_t transform_records(const program::WorkLog& log) {
  return accel::walks_bvh(log.traversal) ? static_cast<std::uint64_t>(std::ranges::count_if(
                                               log.topology.nodes, &accel::TopologyNode::instance))
                                         : 0;
}

std::optional<TreePlan> tree_plan_of(const program::WorkLog& log, const machine::MachineConfig& config,
                                     std::vector<BranchStart> starts) {
  if (config.build.sharing == machine::Sharing::given) {
    return std::nullopt;
  }
  if (starts.empty()) {
    starts = branch_starts(log.topology, config.build);
  }
  check_starts(log.topology, starts);
  return TreePlan(log.topology, std::move(starts), config);
}

std::uint64_t memory_lines(const machine::MachineConfig& config, const memory::Layout& layout,
                           const TreePlan* plan) {
  return (plan != nullptr ? plan->end() : layout.end()) / config.reference_bytes() + 1;
}

std::uint32_t inline_record_bytes(const program::WorkLog& log, const memory::LayoutConfig& layout) {
  if (log.quadrics.empty()) {
    return layout.primitive_bytes;
  }
  return log.triangles() == 0 ? layout.quadric_bytes : std::max(layout.primitive_bytes, layout.quadric_bytes);
}

StackPlaces stack_places(const program::WorkLog& log, const machine::MachineConfig& config,
                         const memory::Layout& layout) {
  // A branch on a ray's way leaves all children but one to wait.
  const std::vector<accel::TopologyNode>& nodes = log.topology.nodes;
  std::uint64_t deepest = 0;
  std::uint64_t children = 1;
  for (const accel::TopologyNode& node : nodes) {
    deepest = std::max<std::uint64_t>(deepest, node.level);
    children = std::max<std::uint64_t>(children, node.leaf ? 0 : node.count);
  }
  const std::uint64_t entries = (deepest - (nodes.empty() ? 0 : nodes.front().level)) * (children - 1);
  StackPlaces places;
  places.begin = layout.room();
  places.lane_bytes = sim::round_up(entries * machine::stack_entry_bytes, config.reference_bytes());
  places.node_bytes =
      sim::round_up(places.lane_bytes * config.simt.lanes * config.simt.warps, config.cache.cache.line);
  return places;
}

memory::Layout layout_of(const program::WorkLog& log, const machine::MachineConfig& config,
                         std::optional<TreePlan>& plan) {
  memory::LayoutConfig records = config.layout;
  const bool inline_records = records.leaf == memory::LeafLayout::inline_records;
  if (inline_records) {
    records.primitive_bytes = inline_record_bytes(log, config.layout);
  }
  const std::uint64_t entries = log.topology.entries.size();
  const memory::RecordCounts counts = {plan ? plan->initial_nodes() : node_records(log),
                                       transform_records(log),
                                       plan             ? plan->initial_entries()
                                       : inline_records ? 0
                                                        : entries,
                                       inline_records ? entries : log.primitives,
                                       log.materials,
                                       log.texture_begin.empty() ? 0 : log.texture_begin.back(),
                                       std::uint64_t{log.width} * log.height};
  memory::Layout layout(records, counts, inline_records ? 0 : log.quadrics.size());
  const std::uint32_t unit = config.reference_bytes();
  if (config.kind == machine::NodeKind::simt && config.rt.stack > 0) {
    layout.add_room(stack_places(log, config, layout).node_bytes * config.nodes, config.cache.cache.line);
  }
  if (plan) {
    plan->place_behind(layout, unit);
  }
  if (std::max(layout.end(), plan ? plan->end() : 0) / unit >= memory::no_line) {
    throw sim::KeyError("cache.line", "the database has 2^32 or more lines; use longer cache lines");
  }
  if (config.banks.dram) {
    const bool shared_tree = plan && config.build.sharing == machine::Sharing::shared;
    const memory::Address end = std::max(layout.end(), shared_tree ? plan->end() : 0);
    if (end > config.banks.dram->capacity()) {
      throw sim::KeyError("dram.rows",
                          "scene and image take " + std::to_string(end) + " bytes, and the memory holds " +
                              std::to_string(config.banks.dram->capacity()) + "; use more or longer rows");
    }
  }
  return layout;
}

std::vector<std::uint32_t> node_ranks(const program::WorkLog& log, const machine::MachineConfig& config) {
  return node_rank(log.topology, !accel::walks_bvh(log.traversal), config.layout);
}

}  // namespace marti::processors::walk
