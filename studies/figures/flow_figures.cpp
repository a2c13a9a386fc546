#include "studies/figures/flow_figures.h"

#include <algorithm>
#include <cmath>

#include "processors/flow/pipeline/stages.h"

namespace marti::studies::figures {

using processors::cost::Activity;
using processors::machine::MachineConfig;
using processors::machine::Scheme;
using processors::replay::MachineResult;

namespace {

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

// Adds a node's part of the frame to a load; means are sums until the end.
void add_node(const MachineResult& result, std::size_t node, StageLoad& load) {
  const processors::cost::TimeDivision& time = result.nodes[node].time;
  const auto of = [&](Activity activity) { return time[static_cast<std::size_t>(activity)]; };
  const auto end = static_cast<double>(result.end);
  const sim::Ticks waits = of(Activity::message_wait) + of(Activity::queue_full_wait) +
                           of(Activity::dispatch_wait) + of(Activity::idle);
  load.work += result.end - waits;
  const double busy = share(static_cast<double>(result.end - waits), end);
  ++load.nodes;
  load.busy += busy;
  load.busiest = std::max(load.busiest, busy);
  load.queue_full += share(static_cast<double>(of(Activity::queue_full_wait)), end);
  load.longest_queue = std::max(load.longest_queue, result.flow.nodes[node].longest_queue);
}

void divide(StageLoad& load) {
  load.busy = share(load.busy, static_cast<double>(load.nodes));
  load.queue_full = share(load.queue_full, static_cast<double>(load.nodes));
}

}  // namespace

const StageLoad& FlowFigures::slowest() const {
  if (stages.empty()) {
    return all;
  }
  return *std::ranges::max_element(stages, {}, &StageLoad::busy);
}

namespace {

// The time, in ps, for which contributions occupy the link into the host; 0 if the host has no link of its
// own.
double host_link(const MachineConfig& machine, const MachineResult& result) {
  const memory::NetworkConfig& network = machine.network;
  if (network.kind == memory::NetworkKind::ideal || network.kind == memory::NetworkKind::bus) {
    return 0.0;
  }
  const double beats = std::ceil(static_cast<double>(machine.messages.contribution_bytes) / network.width);
  const auto beat = static_cast<double>(network.clock.cycles(network.cycles_per_beat));
  return static_cast<double>(result.flow.collected) * beats * beat;
}

}  // namespace

FlowFigures flow_figures(const MachineConfig& machine, const MachineResult& result) {
  FlowFigures figures;
  figures.all.name = "nodes";
  const bool pipeline = machine.scheme == Scheme::pipeline;
  if (pipeline) {
    for (const std::string_view name : processors::flow::stage_names) {
      figures.stages.emplace_back().name = name;
    }
  }
  for (std::size_t node = 0; node < result.nodes.size(); ++node) {
    add_node(result, node, figures.all);
    if (pipeline) {
      const auto port = static_cast<std::uint32_t>(node % machine.nodes);
      const processors::flow::Stage stage = processors::flow::stage_of_node(machine.pipeline, port);
      add_node(result, node, figures.stages[static_cast<std::size_t>(stage)]);
    }
  }
  divide(figures.all);
  for (StageLoad& stage : figures.stages) {
    divide(stage);
  }
  const double ways = static_cast<double>(result.end) * machine.clusters;
  if (ways > 0.0) {
    // Sending the last ray may keep the host busy beyond the frame's end.
    figures.host = std::min(1.0, static_cast<double>(result.host.busy) / ways);
    figures.host_link = host_link(machine, result) / ways;
  }
  return figures;
}

}  // namespace marti::studies::figures
