#include "studies/show/flow_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sim/statistics.h"
#include "studies/figures/flow_figures.h"
#include "studies/show/json_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;
using processors::FlowCounts;
using processors::MachineConfig;
using processors::MachineResult;
using processors::Scheme;

FlowCounts sum_of_nodes(const MachineResult& result) {
  FlowCounts sum;
  for (const FlowCounts& node : result.flow.nodes) {
    sim::merge(sum, node);
  }
  return sum;
}

Json load_json(const StageLoad& load) {
  return {{"name", load.name},
          {"nodes", load.nodes},
          {"busy", load.busy},
          {"busiest_node", load.busiest},
          {"imbalance", optional_json(load.imbalance())},
          {"queue_full", load.queue_full},
          {"longest_queue", load.longest_queue}};
}

Json networks_json(const processors::FlowResult& flow) {
  Json networks = Json::array();
  for (const memory::NetworkStatistics& network : flow.networks) {
    Json object = counters_json(network);
    object["waits"] = counters_json(network.waits);
    networks.push_back(object);
  }
  return networks;
}

std::string short_time(double ticks) {
  const double s = ticks / static_cast<double>(sim::ticks_per_second);
  return s >= 1e-3 ? fmt::format("{:.3f} ms", s * 1e3) : fmt::format("{:.3f} us", s * 1e6);
}

double ratio(std::int64_t part, std::int64_t whole) { return sim::ratio(part, whole).value_or(0.0); }

void load_line(std::back_insert_iterator<std::string> out, const StageLoad& load) {
  fmt::format_to(out, "  {:<12}{} node{}, {:.1f} % busy (the busiest {:.1f} %", load.name, load.nodes,
                 load.nodes == 1 ? "" : "s", 100.0 * load.busy, 100.0 * load.busiest);
  if (const std::optional<double> imbalance = load.imbalance()) {
    fmt::format_to(out, ", imbalance {:.2f}", *imbalance);
  }
  fmt::format_to(out, "), {:.1f} % before full queues, longest queue {}\n", 100.0 * load.queue_full,
                 load.longest_queue);
}

}  // namespace

nlohmann::ordered_json flow_json(const MachineConfig& machine, const MachineResult& result, bool per_node) {
  const FlowFigures figures = flow_figures(machine, result);
  const processors::FlowResult& flow = result.flow;
  Json stages = Json::array();
  for (const StageLoad& stage : figures.stages) {
    stages.push_back(load_json(stage));
  }
  Json nodes = nullptr;
  if (per_node) {
    nodes = Json::array();
    for (std::size_t node = 0; node < flow.nodes.size(); ++node) {
      nodes.push_back(counters_json(flow.nodes[node]));
      nodes.back()["memory_bytes"] = flow.memory_bytes[node];
    }
  }
  return {{"load", load_json(figures.all)},
          {"stages", stages},
          {"networks", networks_json(flow)},
          {"per_node", nodes}};
}

std::string flow_lines(const MachineConfig& machine, const MachineResult& result) {
  std::string text;
  if (machine.scheme == Scheme::image) {
    return text;
  }
  const auto out = std::back_inserter(text);
  const FlowFigures figures = flow_figures(machine, result);
  const processors::FlowResult& flow = result.flow;
  const FlowCounts counts = sum_of_nodes(result);
  const auto rays = static_cast<std::int64_t>(flow.rays);
  fmt::format_to(out, "\nrays          {}, at most {} in flight, at most {} set aside at a node\n", flow.rays,
                 flow.most_in_flight, counts.most_set_aside);
  fmt::format_to(out, "  messages    {}, {:.1f} a ray, {} ({:.0f} B a ray)\n", figures.messages,
                 ratio(figures.messages, rays), bytes(static_cast<double>(figures.bytes)),
                 ratio(figures.bytes, rays));
  fmt::format_to(out, "  queues      mean wait {}\n", short_time(ratio(counts.queued, counts.taken)));
  for (const StageLoad& stage : figures.stages) {
    load_line(out, stage);
  }
  load_line(out, figures.all);
  if (figures.most_memory == 0) {
    fmt::format_to(out, "  memory      none in the nodes: the database is in the clusters' memories\n");
  } else {
    fmt::format_to(out, "  memory      of a node: {} to {}, mean {}\n",
                   bytes(static_cast<double>(figures.least_memory)),
                   bytes(static_cast<double>(figures.most_memory)), bytes(figures.mean_memory));
  }
  if (machine.scheme == Scheme::space) {
    fmt::format_to(out, "  regions     {}, below {} nodes that all have; {} primitives more than once\n",
                   flow.regions, flow.top_nodes, flow.duplicated_primitives);
    if (machine.space.policy == processors::RegionPolicy::sampled) {
      fmt::format_to(out, "  pre-pass    {} of one node's computing before the frame\n",
                     short_time(static_cast<double>(flow.sampling_work)));
    }
  }
  fmt::format_to(out, "network       {}",
                 memory::network_kind_names[static_cast<std::size_t>(machine.network.kind)]);
  if (figures.network) {
    memory::WaitStatistics waits;
    for (const memory::NetworkStatistics& network : flow.networks) {
      waits.count += network.waits.count;
      waits.sum = sim::add_ticks(waits.sum, network.waits.sum);
      waits.max = std::max(waits.max, network.waits.max);
    }
    fmt::format_to(out, ", links {:.1f} % busy, {:.1f} hops a message, mean wait {}, longest {}",
                   100.0 * *figures.network, figures.hops_a_message,
                   short_time(ratio(waits.sum, waits.count)), short_time(static_cast<double>(waits.max)));
  }
  text += "\n";
  return text;
}

}  // namespace marti::studies
