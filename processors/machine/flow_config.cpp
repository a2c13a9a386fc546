#include "processors/machine/flow_config.h"

#include <algorithm>
#include <limits>
#include <string>

#include "processors/machine/machine_config.h"
#include "sim/key_error.h"

namespace marti::processors::machine {

namespace {

void check_stages(const PipelineConfig& pipeline, std::uint32_t nodes) {
  if (nodes < pipeline_stages) {
    throw sim::KeyError("machine.nodes", "a pipeline needs at least 3 nodes, one for each stage, not " +
                                             std::to_string(nodes));
  }
  const std::uint64_t sum = std::uint64_t{pipeline.search} + pipeline.nearest + pipeline.shade;
  if (pipeline.search == 0 || pipeline.nearest == 0 || pipeline.shade == 0 || sum != nodes) {
    throw sim::KeyError(
        "pipeline.search",
        "with pipeline.nearest and pipeline.shade: each stage needs a node, and together they must be "
        "machine.nodes = " +
            std::to_string(nodes) + ", not " + std::to_string(pipeline.search) + " + " +
            std::to_string(pipeline.nearest) + " + " + std::to_string(pipeline.shade) + " = " +
            std::to_string(sum));
  }
  if (pipeline.queue == 0) {
    throw sim::KeyError("pipeline.queue", "a node needs room for at least one ray");
  }
  if (pipeline.in_flight > most_in_flight(pipeline)) {
    throw sim::KeyError("pipeline.in_flight", "more than " + std::to_string(most_in_flight(pipeline)) +
                                                  " rays at a time could deadlock these stages and queues");
  }
}

}  // namespace

PipelineConfig default_stages(std::uint32_t nodes) {
  PipelineConfig pipeline;
  const std::uint64_t n = nodes;
  pipeline.shade = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, n * 2 / 16));
  pipeline.nearest = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, n * 9 / 16));
  const std::uint32_t others = pipeline.shade + pipeline.nearest;
  pipeline.search = nodes > others ? nodes - others : 1;
  return pipeline;
}

std::uint32_t most_in_flight(const PipelineConfig& pipeline) {
  const std::uint64_t others = std::min(pipeline.nearest, pipeline.shade);
  const std::uint64_t rays = (pipeline.search + others) * (std::uint64_t{pipeline.queue} + 1) - 1;
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(rays, std::numeric_limits<std::uint32_t>::max() / 2));
}

void check_flow(const MachineConfig& config) {
  if (config.scheme == Scheme::image) {
    return;
  }
  if (config.messages.ray_bytes == 0 || config.messages.contribution_bytes == 0) {
    throw sim::KeyError(config.messages.ray_bytes == 0 ? "messages.ray_bytes" : "messages.contribution_bytes",
                        "must not be 0");
  }
  if (config.network.width == 0) {
    throw sim::KeyError("network.width", "must be at least one byte");
  }
  if (config.scheme == Scheme::pipeline) {
    check_stages(config.pipeline, config.nodes);
  }
}

}  // namespace marti::processors::machine
