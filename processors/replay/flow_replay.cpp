#include "processors/replay/flow_replay.h"

#include <optional>

#include "processors/path/path_recorder.h"
#include "processors/replay/bounds.h"
#include "processors/replay/interval_sampler.h"
#include "processors/replay/replay_parts.h"
#include "processors/walk/observer.h"
#include "processors/walk/record_places.h"
#include "sim/key_error.h"

namespace marti::processors::replay {

MachineResult replay_flow(const program::WorkLog& log, const machine::MachineConfig& config,
                          const ReplayOptions& options, std::uint32_t limit, const MakeFlowNodes& make) {
  if (!options.starts.empty()) {
    throw sim::KeyError("build.sharing", "start states of branches need the image scheme");
  }
  std::optional<walk::TreePlan> given;
  const memory::Layout layout = walk::layout_of(log, config, given);
  const machine::PacketList packets = packets_of(log, config, options.packet_seed);
  const std::vector<std::uint32_t> rank = walk::node_ranks(log, config);
  sim::Engine engine;
  engine.reserve(std::size_t{config.all_nodes()} + config.clusters);
  flow::FlowHost host(log, packets, config, limit, options.meter);
  std::vector<std::unique_ptr<memory::Network>> networks;
  walk::ReplayInput input{log, config, layout, packets, rank, options.step_by_step};
  input.observer = options.observer;
  input.causes = options.path;
  sim::ensure(options.path == nullptr || options.observer != nullptr,
              "a critical path is recorded of replays that are observed");
  if (input.observer != nullptr) {
    input.observer->begin(input);
  }
  flow::FlowParts parts{input, engine, host, {}};
  for (std::uint32_t cluster = 0; cluster < config.clusters; ++cluster) {
    networks.push_back(memory::make_network(config.network, config.nodes));
    parts.networks.push_back(networks.back().get());
  }
  const std::unique_ptr<flow::FlowNodes> nodes = make(parts);
  const Interconnects interconnects =
      connect_memory(config, engine, static_cast<std::uint8_t>(flow::FlowEvent::memory), *nodes, options.path,
                     options.observer);
  for (const flow::FlowEvent c :
       {flow::FlowEvent::step, flow::FlowEvent::reply, flow::FlowEvent::read, flow::FlowEvent::done,
        flow::FlowEvent::wake, flow::FlowEvent::admit, flow::FlowEvent::memory}) {
    engine.attach(static_cast<std::uint8_t>(c), *nodes);
  }
  const auto result_at = [&](sim::Ticks end) {
    MachineResult result = common_result(config, engine, *nodes, interconnects, layout, end);
    result.host = host.statistics();
    result.packets = packets.size();
    flow::FlowResult& flow = result.flow;
    flow.memory_bytes.assign(
        config.all_nodes(), config.placement == machine::Placement::replicated ? layout.database_bytes() : 0);
    flow.collected = host.collected();
    flow.most_in_flight = host.most_in_flight();
    for (const auto& network : networks) {
      flow.networks.push_back(network->statistics());
    }
    nodes->report(flow);
    flow.rays = host.sent();
    for (const flow::FlowCounts& node : flow.nodes) {
      flow.rays += node.made;
    }
    return result;
  };
  IntervalSampler sampler(options.intervals, engine, *nodes, result_at);
  sampler.run(options.start_seed);
  nodes->finish();
  sampler.finish();

  if (input.observer != nullptr) {
    input.observer->end(nodes->end());
  }
  MachineResult result = result_at(nodes->end());
  result.events -= sampler.events();
  sim::ensure(host.in_flight() == 0, "rays are left over");
  check_conservation(log, config, result);
  check_bounds(config, result);
  return result;
}

}  // namespace marti::processors::replay
