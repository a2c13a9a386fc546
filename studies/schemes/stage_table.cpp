#include "studies/schemes/stage_table.h"

#include <algorithm>
#include <set>
#include <string>

#include "processors/replay.h"

namespace marti::studies {

using processors::Activity;

namespace {

using Shares = std::array<std::uint32_t, pipeline_stages>;

StagePoint time_shares(const SchemesConfig& config, const processors::WorkLog& log, const Shares& nodes) {
  const NamedMachine machine = read_machine_file(
      config.stage_machine,
      {"machine.nodes=" + std::to_string(config.stage_nodes), "pipeline.search=" + std::to_string(nodes[0]),
       "pipeline.nearest=" + std::to_string(nodes[1]), "pipeline.shade=" + std::to_string(nodes[2])});
  const processors::MachineResult result = processors::replay(log, machine.config);
  StagePoint point;
  point.nodes = nodes;
  point.end = result.end;
  // Every cluster has the same stages, in this order.
  for (std::size_t node = 0; node < result.nodes.size(); ++node) {
    const std::size_t port = node % machine.config.nodes;
    const std::size_t stage = port < nodes[0] ? 0 : port < std::size_t{nodes[0]} + nodes[1] ? 1 : 2;
    const processors::TimeDivision& time = result.nodes[node].time;
    sim::Ticks rest = 0;
    for (const Activity activity :
         {Activity::message_wait, Activity::queue_full_wait, Activity::dispatch_wait, Activity::idle}) {
      rest += time[static_cast<std::size_t>(activity)];
    }
    point.busy[stage] += static_cast<double>(result.end - rest);
  }
  for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
    const double whole = static_cast<double>(result.end) * nodes[stage] * machine.config.clusters;
    point.busy[stage] = whole > 0.0 ? point.busy[stage] / whole : 0.0;
  }
  return point;
}

}  // namespace

std::size_t StagePoint::slowest() const {
  return static_cast<std::size_t>(std::max_element(busy.begin(), busy.end()) - busy.begin());
}

std::vector<StagePoint> time_stages(const SchemesConfig& config, const processors::WorkLog& log) {
  std::vector<StagePoint> points;
  if (config.stage_machine.empty()) {
    return points;
  }
  Shares nodes;
  constexpr auto stages = static_cast<std::uint32_t>(pipeline_stages);
  nodes.fill(config.stage_nodes / stages);
  nodes[0] += config.stage_nodes % stages;
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

Table stage_table(std::span<const StagePoint> points) {
  Table table("stages", "Stages: a pipeline's nodes shared out in several ways",
              {{"step", ColumnType::integer, "1", "number of the way of sharing out"},
               {"shares", ColumnType::text, "", "nodes that search, intersect and shade"},
               {"stage", ColumnType::text, "", "one of the stages"},
               {"nodes", ColumnType::integer, "1", "its nodes"},
               {"busy", ColumnType::real, "fraction", "share of its nodes' time in which they worked"},
               {"end", ColumnType::integer, "ps", "time of the frame"}});
  for (std::size_t step = 0; step < points.size(); ++step) {
    const StagePoint& point = points[step];
    const std::string shares = std::to_string(point.nodes[0]) + " + " + std::to_string(point.nodes[1]) +
                               " + " + std::to_string(point.nodes[2]);
    for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
      table.add_row({count_cell(step + 1), shares, std::string(stage_names[stage]),
                     count_cell(point.nodes[stage]), point.busy[stage], point.end});
    }
  }
  return table;
}

}  // namespace marti::studies
