#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "sim/mapped.h"
#include "studies/figures/flow_figures.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;
using processors::machine::MachineConfig;
using processors::machine::Scheme;

Json load_json(const figures::StageLoad& load) {
  return {{"name", load.name},
          {"nodes", load.nodes},
          {"busy", load.busy},
          {"busiest_node", load.busiest},
          {"imbalance", optional_json(load.imbalance())},
          {"queue_full", load.queue_full},
          {"longest_queue", load.longest_queue}};
}

Json networks_json(const processors::flow::FlowResult& flow) {
  Json networks = Json::array();
  for (const memory::NetworkStatistics& network : flow.networks) {
    Json object = counters_json(network);
    object["waits"] = counters_json(network.waits);
    networks.push_back(object);
  }
  return networks;
}

double figure(const run::RunResult& r, const std::string& name) { return r.figure(name).value_or(0.0); }

std::string bytes_of(const run::RunResult& r, std::string_view figure) {
  return tables::bytes(static_cast<double>(r.count(figure)));
}

void load_line(std::back_insert_iterator<std::string> out, const figures::StageLoad& load) {
  fmt::format_to(out, "  {:<12}{}, {} busy (the busiest {}", load.name, tables::counted(load.nodes, "node"),
                 tables::rough_percent(load.busy), tables::rough_percent(load.busiest));
  if (const std::optional<double> imbalance = load.imbalance()) {
    fmt::format_to(out, ", imbalance {:.2f}", *imbalance);
  }
  fmt::format_to(out, "), {} before full queues, longest queue {}\n", tables::rough_percent(load.queue_full),
                 load.longest_queue);
}

}  // namespace

nlohmann::ordered_json flow_json(const run::RunResult& r) {
  if (r.machine.scheme == Scheme::image) {
    return nullptr;
  }
  const figures::FlowFigures figures = figures::flow_figures(r.machine, r.timed);
  const processors::flow::FlowResult& flow = r.timed.flow;
  const Json stages =
      sim::mapped(figures.stages, [&](const figures::StageLoad& stage) { return load_json(stage); });
  Json nodes = counters_list(flow.nodes);
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    nodes[node]["memory_bytes"] = flow.memory_bytes[node];
  }
  return {{"load", load_json(figures.all)},
          {"stages", stages},
          {"networks", networks_json(flow)},
          {"per_node", nodes}};
}

std::string flow_lines(const run::RunResult& r) {
  const MachineConfig& machine = r.machine;
  std::string text;
  if (machine.scheme == Scheme::image) {
    return text;
  }
  const auto out = std::back_inserter(text);
  const figures::FlowFigures figures = figures::flow_figures(machine, r.timed);
  fmt::format_to(out, "\nrays          {}, at most {} in flight, at most {} set aside at a node\n",
                 tables::grouped(r.count("flow_rays")), tables::grouped(r.count("flow_most_in_flight")),
                 tables::grouped(r.count("flow_most_set_aside")));
  fmt::format_to(out, "  messages    {}, {:.1f} a ray, {} ({:.0f} B a ray)\n",
                 tables::grouped(r.count("network_messages")), figure(r, "messages_a_ray"),
                 bytes_of(r, "network_bytes"), figure(r, "message_bytes_a_ray"));
  fmt::format_to(out, "  queues      mean wait {}\n", tables::computed_seconds(figure(r, "mean_queue_wait")));
  for (const figures::StageLoad& stage : figures.stages) {
    load_line(out, stage);
  }
  load_line(out, figures.all);
  if (r.count("flow_most_memory") == 0) {
    fmt::format_to(out, "  memory      none in the nodes: the database is in the clusters' memories\n");
  } else {
    fmt::format_to(out, "  memory      of a node: {} to {}, mean {}\n", bytes_of(r, "flow_least_memory"),
                   bytes_of(r, "flow_most_memory"), tables::bytes(figure(r, "mean_node_memory")));
  }
  if (machine.scheme == Scheme::space) {
    fmt::format_to(out, "  regions     {}, below {} nodes that all have; {} primitives more than once\n",
                   tables::grouped(r.count("regions")), tables::grouped(r.count("top_nodes")),
                   tables::grouped(r.count("duplicated_primitives")));
    if (machine.space.policy == processors::machine::RegionPolicy::sampled) {
      fmt::format_to(out, "  pre-pass    {} of one node's computing before the frame\n",
                     tables::seconds(r.count("sampling_work")));
    }
  }
  fmt::format_to(out, "network       {}",
                 memory::network_kind_names[static_cast<std::size_t>(machine.network.kind)]);
  if (const std::optional<double> busy = r.figure("network_utilisation")) {
    fmt::format_to(out, ", links {} busy, {:.1f} hops a message, mean wait {}, longest {}",
                   tables::rough_percent(*busy), figure(r, "hops_a_message"),
                   tables::computed_seconds(figure(r, "mean_network_wait")),
                   tables::seconds(r.count("network_wait_max")));
  }
  text += "\n";
  return text + network_bandwidth_line(r);
}

}  // namespace marti::studies::show
