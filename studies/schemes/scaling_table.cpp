#include "studies/schemes/scaling_table.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "processors/cost/accounting.h"
#include "sim/finished_parts.h"
#include "studies/figures/derived_figures.h"
#include "studies/schemes/tree_tables.h"
#include "studies/tables/text_units.h"

namespace marti::studies::schemes {

namespace {

ScalingPoint point_of(const NamedMachine& machine, const processors::replay::MachineResult& result,
                      const figures::Counts& one_node) {
  ScalingPoint point;
  point.machine = machine.name;
  point.scheme = machine.config.scheme;
  point.nodes = machine.config.all_nodes();
  point.end = result.end;
  point.one_node_end = sim::ticks_of(*figures::count_of(one_node, "end"));
  point.limit = figures::find_limit(machine.config, result);
  const figures::Counts counts = figures::counts_of(machine.config, result);
  const auto figure = [&](std::string_view name) { return figures::figure_of({&counts, &one_node}, name); };
  point.speed_up = figure("speed_up");
  point.efficiency = figure("efficiency");
  point.interconnect = figure("interconnect_utilisation");
  point.hit_ratio = figure("hit_ratio");
  point.idle = figure("share_idle").value_or(0.0);
  point.waiting = processors::cost::sum_of_kinds(
      {processors::cost::ActivityKind::queueing, processors::cost::ActivityKind::delay}, [&](std::size_t i) {
        return figure("share_" + std::string(processors::cost::activity_names[i])).value_or(0.0);
      });
  point.messages = figures::count_of(counts, "network_messages");
  point.message_bytes = figures::count_of(counts, "network_bytes");
  return point;
}

}  // namespace

std::size_t machines_to_time(const SchemesConfig& config) {
  std::size_t machines = config.machines.size();
  for (const std::filesystem::path& file : config.machines) {
    const std::uint32_t fewest = fewest_nodes(read_machine_file(file, config.frame).config);
    machines += static_cast<std::size_t>(
        std::ranges::count_if(config.nodes, [&](std::uint32_t nodes) { return nodes >= fewest; }));
  }
  return machines;
}

std::vector<ScalingPoint> time_machines(const SchemesConfig& config, const processors::program::WorkLog& log,
                                        std::span<const StagePoint> stages) {
  const auto quickest = std::ranges::min_element(stages, {}, &StagePoint::end);
  std::vector<ScalingPoint> points;
  sim::WorkMeter* const meter = config.frame.meter;
  for (const std::filesystem::path& file : config.machines) {
    const NamedMachine own = read_machine_file(file, config.frame);
    processors::machine::PipelineConfig shares = own.config.pipeline;
    if (quickest != stages.end()) {
      shares.search = quickest->nodes[0];
      shares.nearest = quickest->nodes[1];
      shares.shade = quickest->nodes[2];
    }
    const processors::machine::MachineConfig alone = processors::machine::one_node_of(own.config);
    figures::Counts one_node;
    sim::begin_part(meter, "timing " + own.name + " on one node");
    sim::once(
        meter, "machines", own.name + " on one node",
        [&] { one_node = figures::counts_of(alone, processors::replay::replay(log, alone)); }, one_node);
    for (const std::uint32_t nodes : config.nodes) {
      if (nodes < fewest_nodes(own.config)) {
        continue;
      }
      const NamedMachine machine = read_machine_file(file, config.frame, nodes, shares);
      const std::string name = machine.name + " on " + tables::counted(nodes, "node");
      sim::begin_part(meter, "timing " + name);
      ScalingPoint& point = points.emplace_back();
      sim::once(
          meter, "machines", name,
          [&] { point = point_of(machine, processors::replay::replay(log, machine.config), one_node); },
          point.scheme, point.nodes, point.end, point.one_node_end, point.speed_up, point.efficiency,
          point.limit, point.interconnect, point.hit_ratio, point.idle, point.waiting, point.messages,
          point.message_bytes);
      point.machine = machine.name;
    }
  }
  return points;
}

tables::Table scaling_table(std::span<const ScalingPoint> points) {
  tables::Table table(
      "schemes", "Schemes: how machines grow with their nodes",
      {tables::text_column("machine", "file of the machine"),
       tables::text_column("scheme", "its parallel scheme"),
       tables::count_column("nodes", "processor nodes of all clusters"), figure_column("end"),
       tables::integer_column("one_node", "ps", "time of the frame with one node"), figure_column("speed_up"),
       figure_column("efficiency"), tables::text_column("limit", "the largest part of the nodes' time"),
       figure_column("interconnect_utilisation"), figure_column("hit_ratio"),
       tables::real_column("waiting", "fraction", "share of the nodes' time spent in queues"),
       figure_column("share_idle"), figure_column("network_messages"), figure_column("network_bytes")});
  for (const ScalingPoint& point : points) {
    table.add_row({point.machine, processors::machine::scheme_names[static_cast<std::size_t>(point.scheme)],
                   point.nodes, point.end, point.one_node_end, point.speed_up, point.efficiency,
                   figures::name_of(point.limit), point.interconnect, point.hit_ratio, point.waiting,
                   point.idle, point.messages, point.message_bytes});
  }
  return table;
}

std::vector<ScalingPoint> points_of(std::span<const ScalingPoint> points, std::string_view machine) {
  std::vector<ScalingPoint> found;
  std::ranges::copy_if(points, std::back_inserter(found),
                       [&](const ScalingPoint& point) { return point.machine == machine; });
  return found;
}

}  // namespace marti::studies::schemes
