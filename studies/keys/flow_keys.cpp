#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "sim/error.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

using processors::machine::PipelineConfig;
using processors::machine::Scheme;

constexpr std::array<std::pair<std::string_view, std::uint32_t PipelineConfig::*>, 3> stages = {
    {{"pipeline.search", &PipelineConfig::search},
     {"pipeline.nearest", &PipelineConfig::nearest},
     {"pipeline.shade", &PipelineConfig::shade}}};

void read_messages(const sim::Config& config, processors::machine::MessageConfig& messages) {
  messages.ray_bytes = static_cast<std::uint32_t>(config.size("messages.ray"));
  messages.contribution_bytes = static_cast<std::uint32_t>(config.size("messages.contribution"));
  messages.send_cycles = config.integer("messages.send_cycles");
  messages.receive_cycles = config.integer("messages.receive_cycles");
}

// Reads the nodes of each stage; if no stage has any, the default shares are taken.
void read_stages(const sim::Config& config, PipelineConfig& pipeline, std::uint32_t nodes) {
  const PipelineConfig shares = processors::machine::default_stages(nodes);
  std::size_t given = 0;
  for (const auto& [key, member] : stages) {
    pipeline.*member = count(config, key);
    given += pipeline.*member != 0 ? 1 : 0;
  }
  if (given == 0) {
    for (const auto& [key, member] : stages) {
      pipeline.*member = shares.*member;
    }
  } else if (given != stages.size()) {
    for (const auto& [key, member] : stages) {
      if (pipeline.*member != 0) {
        config.fail(key,
                    "give the nodes of all three stages (pipeline.search, pipeline.nearest, pipeline.shade), "
                    "or of none for their shares of machine.nodes");
      }
    }
  }
}

void read_pipeline(const sim::Config& config, processors::machine::MachineConfig& machine) {
  if (machine.nodes < processors::machine::pipeline_stages) {
    config.fail("machine.nodes", "a pipeline needs at least 3 nodes, one for each stage, not " +
                                     std::to_string(machine.nodes));
  }
  PipelineConfig& pipeline = machine.pipeline;
  read_stages(config, pipeline, machine.nodes);
  const std::int64_t sum = std::int64_t{pipeline.search} + pipeline.nearest + pipeline.shade;
  if (sum != machine.nodes) {
    config.fail("pipeline.search",
                "pipeline.search + pipeline.nearest + pipeline.shade = " + std::to_string(sum) +
                    " must be machine.nodes = " + std::to_string(machine.nodes));
  }
  pipeline.queue = count(config, "pipeline.queue");
  const std::int64_t in_flight = config.integer("pipeline.in_flight");
  if (in_flight > processors::machine::most_in_flight(pipeline)) {
    config.fail("pipeline.in_flight", "more than " +
                                          std::to_string(processors::machine::most_in_flight(pipeline)) +
                                          " rays at a time could deadlock these stages and queues");
  }
  pipeline.in_flight = static_cast<std::uint32_t>(in_flight);
}

}  // namespace

void declare_flow_keys(sim::Schema& schema) {
  schema.section("messages", "what nodes send each other in the schemes in which rays move");
  schema.size("messages.ray", "64 B", {"1 B", "64 KiB"},
              "bytes of a ray: origin, direction, weight, pixel, and where in its walk it is");
  schema.size("messages.contribution", "16 B", {"1 B", "64 KiB"},
              "bytes of a contribution to a pixel, sent to the host");
  cycles(schema, "messages.send_cycles", 0, "cycles of a node's clock to compose and send one message");
  cycles(schema, "messages.receive_cycles", 0, "cycles of a node's clock to take one message from its queue");
  schema.section("pipeline", "stages of nodes between which rays go round (machine.scheme = \"pipeline\")");
  schema.integer(stages[0].first, 0, {0, processors::machine::most_nodes}, "",
                 "of each cluster's nodes, those that walk the structure to the next leaf with objects; 0 in "
                 "all three stages: 5, 9 and 2 sixteenths of the nodes");
  schema.integer(stages[1].first, 0, {0, processors::machine::most_nodes}, "",
                 "those that test a leaf's objects");
  schema.integer(stages[2].first, 0, {0, processors::machine::most_nodes}, "",
                 "those that shade hit points and make rays there");
  schema.integer("pipeline.queue", 16, {1, 65536}, "", "rays that may wait before each node");
  schema.integer("pipeline.in_flight", 0, {0, std::int64_t{1} << 31U}, "",
                 "most rays in flight in each cluster; 0: as many as cannot deadlock");
}

void read_flow(sim::Config& config, processors::machine::MachineConfig& machine) {
  if (machine.scheme == Scheme::image) {
    config.mark_unused_reason("messages", "no messages are sent with machine.scheme = \"image\"",
                              "machine.scheme");
  } else {
    read_messages(config, machine.messages);
    config.mark_unused_reason("node.write_buffer", "nodes write no pixels unless machine.scheme = \"image\"",
                              "machine.scheme");
    config.mark_unused_reason("host.assignment", "nodes take no packets unless machine.scheme = \"image\"",
                              "machine.scheme");
  }
  if (machine.scheme == Scheme::pipeline) {
    read_pipeline(config, machine);
  }
  config.mark_unused_reason("pipeline", "it has no effect without machine.scheme = \"pipeline\"",
                            "machine.scheme");
}

}  // namespace marti::studies::keys
