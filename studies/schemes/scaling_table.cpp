#include "studies/schemes/scaling_table.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "sim/statistics.h"

namespace marti::studies {

using processors::Activity;

namespace {

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

double sum_of(const processors::TimeDivision& time, std::initializer_list<Activity> parts) {
  double sum = 0.0;
  for (const Activity part : parts) {
    sum += static_cast<double>(time[static_cast<std::size_t>(part)]);
  }
  return sum;
}

ScalingPoint point_of(const NamedMachine& machine, const processors::MachineResult& result,
                      sim::Ticks one_node_end) {
  ScalingPoint point;
  point.machine = machine.name;
  point.scheme = machine.config.scheme;
  point.nodes = machine.config.all_nodes();
  point.end = result.end;
  point.one_node_end = one_node_end;
  point.scaling = scaling_of(one_node_end, result.end, point.nodes);
  point.limit = find_limit(machine.config, result).limit;
  point.shared_use = utilisation_of(machine.config, result).interconnect;
  const processors::ReferenceCounts references = result.references();
  point.hit_ratio = sim::ratio(references.all_hits(), references.references());
  const processors::TimeDivision time = result.time();
  const double all = static_cast<double>(result.end) * static_cast<double>(result.nodes.size());
  point.idle = share(sum_of(time, {Activity::idle}), all);
  point.waiting =
      share(sum_of(time, {Activity::interconnect_wait, Activity::bank_wait, Activity::lock_wait,
                          Activity::message_wait, Activity::queue_full_wait, Activity::dispatch_wait}),
            all);
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    point.messages += network.messages;
    point.message_bytes += network.bytes;
  }
  return point;
}

}  // namespace

std::vector<ScalingPoint> time_machines(const SchemesConfig& config, const processors::WorkLog& log,
                                        std::span<const StagePoint> stages) {
  const auto quickest = std::min_element(stages.begin(), stages.end(),
                                         [](const auto& a, const auto& b) { return a.end < b.end; });
  std::vector<ScalingPoint> points;
  for (const std::filesystem::path& file : config.machines) {
    const NamedMachine own = read_machine_file(file);
    processors::PipelineConfig shares = own.config.pipeline;
    if (quickest != stages.end()) {
      shares.search = quickest->nodes[0];
      shares.nearest = quickest->nodes[1];
      shares.shade = quickest->nodes[2];
    }
    const sim::Ticks one_node_end = processors::replay(log, one_node_of(own.config)).end;
    for (const std::uint32_t nodes : config.nodes) {
      if (nodes >= fewest_nodes(own.config)) {
        const NamedMachine machine = read_machine_file(file, nodes, shares);
        points.push_back(point_of(machine, processors::replay(log, machine.config), one_node_end));
      }
    }
  }
  return points;
}

Table scaling_table(std::span<const ScalingPoint> points) {
  Table table("schemes", "Schemes: how machines grow with their nodes",
              {{"machine", ColumnType::text, "", "file of the machine"},
               {"scheme", ColumnType::text, "", "its parallel scheme"},
               {"nodes", ColumnType::integer, "1", "processor nodes of all clusters"},
               {"end", ColumnType::integer, "ps", "time of the frame"},
               {"one_node", ColumnType::integer, "ps", "time of the frame with one node"},
               {"speed_up", ColumnType::real, "1", "one_node / end"},
               {"efficiency", ColumnType::real, "fraction", "speed_up / nodes"},
               {"limit", ColumnType::text, "", "the largest part of the nodes' time"},
               {"shared_use", ColumnType::real, "fraction",
                "share of the frame in which the way to the shared memory was busy"},
               {"hit_ratio", ColumnType::real, "fraction", "of the private caches"},
               {"waiting", ColumnType::real, "fraction", "share of the nodes' time spent in queues"},
               {"idle", ColumnType::real, "fraction", "share of the nodes' time after their last work"},
               {"messages", ColumnType::integer, "1", "between different nodes or with the host"},
               {"message_bytes", ColumnType::integer, "byte", "bytes of these messages"}});
  const auto cell = [](const std::optional<double>& value) { return value ? Cell(*value) : Cell(); };
  for (const ScalingPoint& point : points) {
    table.add_row({point.machine,
                   std::string(processors::scheme_names[static_cast<std::size_t>(point.scheme)]),
                   count_cell(point.nodes), point.end, point.one_node_end, cell(point.scaling.speed_up),
                   cell(point.scaling.efficiency), std::string(name_of(point.limit)), cell(point.shared_use),
                   cell(point.hit_ratio), point.waiting, point.idle, point.messages, point.message_bytes});
  }
  return table;
}

std::vector<ScalingPoint> points_of(std::span<const ScalingPoint> points, std::string_view machine) {
  std::vector<ScalingPoint> found;
  std::copy_if(points.begin(), points.end(), std::back_inserter(found),
               [&](const ScalingPoint& point) { return point.machine == machine; });
  return found;
}

}  // namespace marti::studies
