#include "processors/flow/space/space_plan.h"

#include <algorithm>

#include "processors/cost/step_time.h"
#include "processors/flow/space/region_policy.h"
#include "processors/flow/space/region_work.h"
#include "sim/key_error.h"

namespace marti::processors::flow {

namespace {

using memory::RecordKind;

std::vector<std::uint32_t> deal(const program::WorkLog& log, const machine::MachineConfig& config,
                                SpacePlan& plan) {
  const RegionMap& regions = plan.regions;
  switch (config.space.policy) {
    case machine::RegionPolicy::blocks:
      return deal_in_blocks(regions.size(), config.nodes);
    case machine::RegionPolicy::scatter:
      return deal_scattered(regions.size(), config.nodes);
    case machine::RegionPolicy::balanced:
      return deal_balanced(
          distinct_primitives(log.topology, regions.region_of, regions.size(), log.primitives), config.nodes);
    case machine::RegionPolicy::sampled: {
      const RegionWork work =
          sample_work(log, regions, cost::step_ticks(config, log), config.space.sample_step);
      plan.sampling_work = work.total;
      return deal_balanced(work.of, config.nodes);
    }
  }
  throw sim::InternalError("space: an unknown policy");
}

// Bytes from a primitive's record to the next record.
std::uint64_t stride_of(const memory::Layout& layout, std::uint64_t primitive) {
  return layout.address(RecordKind::primitive, primitive + 1) -
         layout.address(RecordKind::primitive, primitive);
}

// Bytes of the record of a tree node; the leaves of a bounding volume hierarchy have none.
std::uint64_t record_bytes(const program::WorkLog& log, const memory::Layout& layout, std::size_t number) {
  return log.topology.nodes[number].leaf && accel::walks_bvh(log.traversal) ? 0
                                                                            : layout.stride(RecordKind::node);
}

// Bytes of the records that every node has.
std::uint64_t top_bytes(const program::WorkLog& log, const memory::Layout& layout, const SpacePlan& plan) {
  std::uint64_t bytes = 0;
  for (std::size_t number = 0; number < plan.owner.size(); ++number) {
    bytes += plan.owner[number] == RegionMap::top ? record_bytes(log, layout, number) : 0;
  }
  return bytes;
}

// Adds the records of each node's regions to its memory, and counts primitives that are held twice or more.
void add_regions(const program::WorkLog& log, const memory::Layout& layout, SpacePlan& plan) {
  const accel::Topology& topology = log.topology;
  for (std::size_t number = 0; number < topology.nodes.size(); ++number) {
    if (plan.owner[number] != RegionMap::top) {
      const accel::TopologyNode& node = topology.nodes[number];
      const std::uint64_t entries = node.leaf ? node.count : 0;
      plan.memory_bytes[plan.owner[number]] +=
          record_bytes(log, layout, number) + entries * layout.stride(RecordKind::list);
    }
  }
  std::vector<bool> is_held(log.primitives);  // by any node so far
  each_distinct_primitive(topology, plan.owner, static_cast<std::uint32_t>(plan.memory_bytes.size()),
                          log.primitives, [&](std::uint32_t node, std::uint32_t primitive) {
                            plan.memory_bytes[node] += stride_of(layout, primitive);
                            plan.duplicated_primitives += is_held[primitive] ? 1 : 0;
                            is_held[primitive] = true;
                          });
}

}  // namespace

SpacePlan plan_space(const program::WorkLog& log, const machine::MachineConfig& config,
                     const memory::Layout& layout) {
  if (config.space.level == 0) {
    throw sim::KeyError("space.level", "the root is level 1");
  }
  if (config.space.sample_step == 0) {
    throw sim::KeyError("space.sample_step", "must be at least 1");
  }
  if (config.space.queue == 0) {
    throw sim::KeyError("space.queue", "a node needs room for at least one ray");
  }
  if (accel::has_instances(log.topology)) {
    throw sim::KeyError(
        "structure.instances",
        "a kept mesh lies in all regions that its instances are in, and so belongs to no node; "
        "set \"copied\" to divide space");
  }
  SpacePlan plan;
  plan.regions = cut_regions(log.topology, config.space.level);
  plan.node_of_region = deal(log, config, plan);
  plan.owner.resize(log.topology.nodes.size());
  std::transform(plan.regions.region_of.begin(), plan.regions.region_of.end(), plan.owner.begin(),
                 [&](std::uint32_t region) {
                   return region == RegionMap::top ? RegionMap::top : plan.node_of_region[region];
                 });
  plan.memory_bytes.assign(config.nodes, top_bytes(log, layout, plan) +
                                             layout.section_bytes(RecordKind::material) +
                                             layout.section_bytes(RecordKind::texel));
  add_regions(log, layout, plan);
  return plan;
}

}  // namespace marti::processors::flow
