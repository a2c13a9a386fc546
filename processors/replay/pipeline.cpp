#include "processors/replay/pipeline.h"

#include <memory>
#include <utility>

#include "processors/flow/pipeline/pipeline_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/replay/flow_replay.h"
#include "processors/walk/counted_caches.h"

namespace marti::processors {

MachineResult replay_pipeline(const WorkLog& log, const MachineConfig& config, const ReplayOptions& options) {
  const std::uint32_t limit =
      config.pipeline.in_flight != 0 ? config.pipeline.in_flight : most_in_flight(config.pipeline);
  return replay_flow(log, config, options, limit, [](const FlowParts& parts) {
    const auto make = [&]<class Caches>(Caches caches) -> std::unique_ptr<FlowNodes> {
      return std::make_unique<PipelineNodes<Caches>>(parts, std::move(caches));
    };
    const MachineConfig& machine = parts.input.config;
    return machine.count.any() ? with_counted_caches(parts.input, make) : with_caches(machine, make);
  });
}

}  // namespace marti::processors
