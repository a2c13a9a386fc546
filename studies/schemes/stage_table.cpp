#include "studies/schemes/stage_table.h"

#include <algorithm>
#include <set>
#include <string>

#include "processors/replay/replay.h"
#include "studies/figures/flow_figures.h"

namespace marti::studies::schemes {

namespace {

using Shares = std::array<std::uint32_t, pipeline_stages>;

StagePoint time_shares(const SchemesConfig& config, const processors::program::WorkLog& log,
                       const Shares& nodes) {
  processors::machine::PipelineConfig shares;
  shares.search = nodes[0];
  shares.nearest = nodes[1];
  shares.shade = nodes[2];
  const NamedMachine machine =
      read_machine_file(config.stage_machine, config.frame, config.stage_nodes, shares);
  const processors::replay::MachineResult result = processors::replay::replay(log, machine.config);
  StagePoint point;
  point.nodes = nodes;
  point.end = result.end;
  const figures::FlowFigures figures = figures::flow_figures(machine.config, result);
  for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
    point.busy[stage] = figures.stages[stage].busy;
  }
  return point;
}

}  // namespace

std::size_t StagePoint::slowest() const {
  return static_cast<std::size_t>(std::ranges::max_element(busy) - busy.begin());
}

std::vector<StagePoint> time_stages(const SchemesConfig& config, const processors::program::WorkLog& log) {
  std::vector<StagePoint> points;
  if (config.stage_machine.empty()) {
    return points;
  }
  Shares nodes;
  nodes.fill(config.stage_nodes / pipeline_stages);
  nodes[0] += config.stage_nodes % pipeline_stages;
  std::set<Shares> tried;
  while (tried.insert(nodes).second) {
    points.push_back(time_shares(config, log, nodes));
    const StagePoint& point = points.back();
    const std::size_t slowest = point.slowest();
    std::size_t giver = pipeline_stages;
    for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
      if (stage != slowest && nodes[stage] > 1 &&
          (giver == pipeline_stages || point.busy[stage] < point.busy[giver])) {
        giver = stage;
      }
    }
    if (giver == pipeline_stages) {
      break;
    }
    --nodes[giver];
    ++nodes[slowest];
  }
  return points;
}

tables::Table stage_table(std::span<const StagePoint> points) {
  tables::Table table(
      "stages", "Stages: a pipeline's nodes shared out in several ways",
      {tables::count_column("step", "number of the way of sharing out"),
       tables::text_column("shares", "nodes that search, intersect and shade"),
       tables::text_column("stage", "one of the stages"), tables::count_column("nodes", "its nodes"),
       tables::real_column("busy", "fraction", "share of its nodes' time in which they worked"),
       tables::integer_column("end", "ps", "time of the frame")});
  for (std::size_t step = 0; step < points.size(); ++step) {
    const StagePoint& point = points[step];
    const std::string shares = std::to_string(point.nodes[0]) + " + " + std::to_string(point.nodes[1]) +
                               " + " + std::to_string(point.nodes[2]);
    for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
      table.add_row({step + 1, shares, stage_names[stage], point.nodes[stage], point.busy[stage], point.end});
    }
  }
  return table;
}

}  // namespace marti::studies::schemes
