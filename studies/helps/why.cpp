#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "studies/figures/derived_figures.h"
#include "studies/figures/flow_figures.h"
#include "studies/figures/memory_names.h"
#include "studies/helps/verdict.h"

namespace marti::studies::helps {

namespace {

using processors::cost::Activity;
using processors::machine::MachineConfig;
using processors::replay::MachineResult;

double figure(const figures::Counts& counts, std::string_view name) {
  return figures::figure_of({&counts}, name).value_or(0.0);
}

// These activities' share of all nodes' time.
double share(const figures::Counts& counts, std::initializer_list<Activity> activities) {
  double sum = 0.0;
  for (const Activity activity : activities) {
    const std::string_view name = processors::cost::activity_names[static_cast<std::size_t>(activity)];
    sum += figure(counts, "share_" + std::string(name));
  }
  return sum;
}

double percent(const figures::Counts& counts, Activity activity) { return 100.0 * share(counts, {activity}); }

double computing(const figures::Counts& counts) {
  return processors::cost::sum_of_kinds({processors::cost::ActivityKind::computing}, [&](std::size_t i) {
    return share(counts, {static_cast<Activity>(i)});
  });
}

double start_up(const figures::Counts& counts) {
  return figure(counts, "build_start_up_wait") / (figure(counts, "end") * figure(counts, "nodes"));
}

double on_memory(const figures::Counts& counts) {
  return share(counts,
               {Activity::interconnect_wait, Activity::transfer, Activity::bank_wait, Activity::bank_access});
}

// What nodes do most while they do not compute, if that takes more of their time.
std::string more_than_computing(const figures::Counts& counts) {
  const std::initializer_list<std::pair<double, std::string_view>> waits = {
      {share(counts, {Activity::idle}), "idle"},
      {share(counts, {Activity::dispatch_wait}) - start_up(counts), "waiting for packets"},
      {share(counts, {Activity::message_wait}), "waiting for rays"},
      {share(counts, {Activity::queue_full_wait}), "waiting for room"},
      {share(counts, {Activity::lock_wait}), "waiting for parts of the tree"},
      {on_memory(counts), "on memory"}};
  const auto* const most = std::ranges::max_element(waits, {}, &std::pair<double, std::string_view>::first);
  return most->first > computing(counts) ? fmt::format(", {:.1f} % {}", 100.0 * most->first, most->second)
                                         : std::string();
}

std::string why_nodes(const std::string& name, const MachineConfig& machine, const MachineResult& result,
                      const figures::Counts& counts) {
  if (machine.scheme == processors::machine::Scheme::pipeline) {
    for (const figures::StageLoad& stage : figures::flow_figures(machine, result).stages) {
      if (name == "pipeline." + stage.name) {
        return fmt::format("the nodes of this stage are {:.1f} % busy", 100.0 * stage.busy);
      }
    }
  }
  std::string text = fmt::format("nodes spend {:.1f} % of their time computing{}", 100.0 * computing(counts),
                                 more_than_computing(counts));
  if (const double waiting = start_up(counts); waiting > 0.0) {
    text += fmt::format(" and {:.1f} % waiting for the initial tree", 100.0 * waiting);
  }
  return text;
}

std::string why_network(const MachineConfig& machine, const figures::Counts& counts) {
  const std::optional<double> busy = figures::figure_of(
      {&counts}, machine.scheme == processors::machine::Scheme::image ? "interconnect_utilisation"
                                                                      : "network_utilisation");
  return busy ? fmt::format("the network's links are {:.1f} % busy", 100.0 * *busy)
              : std::string("every message takes its latency");
}

std::string why_host(const MachineConfig& machine, const MachineResult& result,
                     const figures::Counts& counts) {
  if (machine.scheme != processors::machine::Scheme::image) {
    return fmt::format("camera rays keep the host busy for {:.1f} % of the time",
                       100.0 * figures::flow_figures(machine, result).host);
  }
  return fmt::format("nodes spend {:.1f} % of their time waiting for packets",
                     percent(counts, Activity::dispatch_wait));
}

std::string why_regions(const MachineConfig& machine, const MachineResult& result) {
  const figures::StageLoad all = figures::flow_figures(machine, result).all;
  return fmt::format("the busiest node is {:.1f} % busy, a node on average {:.1f} %", 100.0 * all.busiest,
                     100.0 * all.busy);
}

// The share of all nodes' time, at most 1, that has to do with a part of the machine; of an interconnect and
// of banks the share of the frame in which they are busy, if that is more.
double share_of(Part part, const figures::Counts& counts) {
  switch (part) {
    case Part::nodes:
      return computing(counts);
    case Part::caches:
    case Part::second_level:
    case Part::local_memory:
      return on_memory(counts);
    case Part::interconnect:
      return std::max(share(counts, {Activity::interconnect_wait, Activity::transfer}),
                      figure(counts, "interconnect_utilisation"));
    case Part::banks:
      return std::max(share(counts, {Activity::bank_wait, Activity::bank_access}),
                      figure(counts, "bank_utilisation"));
    case Part::network:
      return share(counts, {Activity::interconnect_wait, Activity::transfer, Activity::message_wait});
    case Part::messages:
      return share(counts, {Activity::messaging, Activity::message_wait});
    case Part::queues:
      return share(counts, {Activity::queue_full_wait});
    case Part::host:
      return share(counts, {Activity::dispatch_wait});
    case Part::building:
      return share(counts, {Activity::building, Activity::lock_wait}) + start_up(counts);
    case Part::regions:
      break;
  }
  return share(counts, {Activity::idle, Activity::message_wait});
}

// How busy a resource is, a share of the frame; of packets how long nodes are idle. Where rays move, a node
// may wait for what is slow elsewhere, so there it is how busy the busiest node, the host or the network is.
double busy_share(const Help& help, const MachineConfig& machine, const figures::FlowFigures& flow,
                  const figures::Counts& counts) {
  if (machine.scheme == processors::machine::Scheme::image) {
    return help.name.starts_with("packets.") ? share(counts, {Activity::idle}) : share_of(help.part, counts);
  }
  switch (help.part) {
    case Part::network:
      return figure(counts, "network_utilisation");
    case Part::messages:
      return share(counts, {Activity::messaging});
    case Part::host:
      return flow.host;
    case Part::regions:
      return flow.all.busiest - flow.all.busy;
    default:
      return share_of(help.part, counts);
  }
}

// What a resource of the nodes takes of a frame in which rays move: a stage the time of its own busiest node;
// more nodes, and faster ones, help the slowest stage or node, and all others too.
double nodes_share(const std::string& name, const figures::FlowFigures& flow) {
  for (const figures::StageLoad& stage : flow.stages) {
    if (name == "pipeline." + stage.name) {
      return stage.busiest;
    }
  }
  return std::max(flow.slowest().busiest, flow.all.busiest);
}

// How much of a SIMT node's waits more of this can fill, from 0 to 1: warps in the unit where others queue
// for it, warps of the node where none do, registers where look-ups find none. std::nullopt: `name` is no
// such setting.
std::optional<double> filled_waits(std::string_view name, const figures::Counts& counts) {
  const auto lanes = [&](std::string_view state) {
    return static_cast<double>(figures::count_of(counts, "simt_lanes_" + std::string(state)).value_or(0));
  };
  double in_unit = 1.0;
  for (const std::string_view state : {"scheduler", "cache", "memory", "box", "primitive"}) {
    in_unit += lanes(state);
  }
  constexpr double some = 0.1;  // as many queue as make it certain that the unit is full
  const double queue = std::min(1.0, lanes("unit") / in_unit / some);
  if (name.starts_with("rt.warps")) {
    return queue;
  }
  if (name.starts_with("simt.warps")) {
    return 1.0 - queue;
  }
  return name.starts_with("cache.mshrs") ? std::optional(figure(counts, "simt_full_share")) : std::nullopt;
}

}  // namespace

double expected_saving(const Help& help, double factor, const MachineConfig& machine,
                       const MachineResult& result, const figures::Counts& counts) {
  const double gone = 1.0 - 1.0 / factor;
  const bool image = machine.scheme == processors::machine::Scheme::image;
  const figures::FlowFigures flow = image ? figures::FlowFigures{} : figures::flow_figures(machine, result);
  if (!image && help.part == Part::nodes) {
    return nodes_share(help.name, flow) * gone;
  }
  const double full = std::max({figure(counts, "interconnect_utilisation"),
                                figure(counts, "bank_utilisation"), figure(counts, "network_utilisation")});
  if (help.part != Part::nodes || help.name.starts_with("packets.")) {
    double takes = busy_share(help, machine, flow, counts);
    if (help.part == Part::caches || help.part == Part::second_level) {
      takes = std::max(takes, full);  // what hits does not queue
    }
    if (help.part == Part::network) {
      takes = std::max(takes, share_of(help.part, counts));  // nodes also wait for rays that are under way
    }
    return takes * gone;
  }
  // Faster nodes, and more of them, ask the way to memory for as much as before.
  const double room = 1.0 - full;
  const double idle = share(counts, {Activity::idle});
  // Looking up in the node's own caches is a wait that other warps can fill.
  const double waiting = 1.0 - idle - computing(counts) + share(counts, {Activity::cache_access});
  const std::optional<double> filled = filled_waits(help.name, counts);
  const double takes = help.name == "machine.nodes"             ? 1.0 - idle
                       : help.name.starts_with("node.contexts") ? 1.0 - idle - computing(counts)
                       : filled                                 ? waiting * *filled
                                                                : computing(counts);
  return std::min(takes * gone, room);
}

std::string why(const Help& help, const MachineConfig& machine, const MachineResult& result,
                const figures::Counts& counts) {
  switch (help.part) {
    case Part::nodes:
      return why_nodes(help.name, machine, result, counts);
    case Part::caches:
    case Part::second_level:
      return fmt::format("nodes spend {:.1f} % of their time on misses", 100.0 * on_memory(counts));
    case Part::local_memory:
      return fmt::format("nodes spend {:.1f} % of their time on memory", 100.0 * on_memory(counts));
    case Part::interconnect:
      if (const std::optional<double> busy = figures::figure_of({&counts}, "interconnect_utilisation")) {
        return fmt::format("the {} is {:.1f} % busy", figures::interconnect_name(machine), 100.0 * *busy);
      }
      return fmt::format("nodes spend {:.1f} % of their time on transfers",
                         percent(counts, Activity::transfer));
    case Part::banks:
      return fmt::format("the busiest {} is {:.1f} % busy", figures::bank_name(machine),
                         100.0 * figure(counts, "bank_utilisation"));
    case Part::network:
      return why_network(machine, counts);
    case Part::messages:
      return fmt::format("nodes spend {:.1f} % of their time on messages and {:.1f} % waiting for rays",
                         percent(counts, Activity::messaging), percent(counts, Activity::message_wait));
    case Part::queues:
      return fmt::format("nodes spend {:.1f} % of their time waiting for room",
                         percent(counts, Activity::queue_full_wait));
    case Part::host:
      return why_host(machine, result, counts);
    case Part::building:
      return fmt::format("nodes spend {:.1f} % of their time building or waiting for parts of the tree",
                         100.0 * share_of(help.part, counts));
    case Part::regions:
      break;
  }
  return why_regions(machine, result);
}

}  // namespace marti::studies::helps
