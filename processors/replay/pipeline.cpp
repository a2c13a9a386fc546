#include "processors/replay/pipeline.h"

#include <memory>
#include <utility>

#include "processors/flow/pipeline/pipeline_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/replay/flow_replay.h"
#include "processors/walk/counted_caches.h"

namespace marti::processors::replay {

MachineResult replay_pipeline(const program::WorkLog& log, const machine::MachineConfig& config,
                              const ReplayOptions& options) {
  const std::uint32_t limit =
      config.pipeline.in_flight != 0 ? config.pipeline.in_flight : machine::most_in_flight(config.pipeline);
  return replay_flow(log, config, options, limit, [](const flow::FlowParts& parts) {
    const auto make = [&]<class Caches>(Caches caches) -> std::unique_ptr<flow::FlowNodes> {
      return std::make_unique<flow::PipelineNodes<Caches>>(parts, std::move(caches));
    };
    const machine::MachineConfig& machine = parts.input.config;
    return walk::needs_counted_caches(parts.input) ? walk::with_counted_caches(parts.input, make)
                                                   : node::with_caches(machine, make);
  });
}

}  // namespace marti::processors::replay
