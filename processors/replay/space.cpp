#include "processors/replay/space.h"

#include <algorithm>
#include <limits>

#include "processors/flow/space/space_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/replay/flow_replay.h"
#include "processors/walk/counted_caches.h"

namespace marti::processors::replay {

std::uint32_t admission_limit(const machine::MachineConfig& config) {
  if (config.space.in_flight != 0) {
    return config.space.in_flight;
  }
  const std::uint64_t half = std::uint64_t{config.nodes} * config.space.queue / 2;
  return static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(half, 1, std::numeric_limits<std::uint32_t>::max() / 2));
}

MachineResult replay_space(const program::WorkLog& log, const machine::MachineConfig& config,
                           const ReplayOptions& options) {
  // Each node reads its own memory, as with a replicated database.
  machine::MachineConfig own_memories = config;
  own_memories.placement = machine::Placement::replicated;
  own_memories.interconnect.kind = memory::InterconnectKind::ideal;  // no interconnect is used
  flow::SpacePlan plan;
  const auto make = [&](const flow::FlowParts& parts) {
    plan = flow::plan_space(log, own_memories, parts.input.layout);
    const auto make_nodes = [&]<class Caches>(Caches caches) -> std::unique_ptr<flow::FlowNodes> {
      return std::make_unique<flow::SpaceNodes<Caches>>(parts, plan, std::move(caches));
    };
    return walk::needs_counted_caches(parts.input) ? walk::with_counted_caches(parts.input, make_nodes)
                                                   : node::with_caches(own_memories, make_nodes);
  };
  MachineResult result = replay_flow(log, own_memories, options, admission_limit(config), make);
  result.copies = config.clusters;
  return result;
}

}  // namespace marti::processors::replay
