#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "studies/figures/derived_figures.h"
#include "studies/figures/find_limit.h"
#include "studies/figures/flow_figures.h"
#include "studies/helps/verdict.h"

namespace marti::studies {

namespace {

using processors::Activity;
using processors::MachineConfig;
using processors::MachineResult;

// These activities' share of all nodes' time.
double share(const MachineResult& result, std::initializer_list<Activity> activities) {
  const processors::TimeDivision time = result.time();
  double sum = 0.0;
  for (const Activity activity : activities) {
    sum += static_cast<double>(time[static_cast<std::size_t>(activity)]);
  }
  return sum / (static_cast<double>(result.end) * static_cast<double>(result.nodes.size()));
}

double percent(const MachineResult& result, std::initializer_list<Activity> activities) {
  return 100.0 * share(result, activities);
}

double computing(const MachineResult& result) {
  return share(result, {Activity::traversal, Activity::intersection, Activity::shading, Activity::building,
                        Activity::cache_access, Activity::switching, Activity::messaging});
}

double start_up(const MachineResult& result) {
  return static_cast<double>(result.build.start_up_wait) /
         (static_cast<double>(result.end) * static_cast<double>(result.nodes.size()));
}

double on_memory(const MachineResult& result) {
  return share(result,
               {Activity::interconnect_wait, Activity::transfer, Activity::bank_wait, Activity::bank_access});
}

// What nodes do most while they do not compute, if that takes more of their time.
std::string more_than_computing(const MachineResult& result) {
  const std::initializer_list<std::pair<double, std::string_view>> waits = {
      {share(result, {Activity::idle}), "idle"},
      {share(result, {Activity::dispatch_wait}) - start_up(result), "waiting for packets"},
      {share(result, {Activity::message_wait}), "waiting for rays"},
      {share(result, {Activity::queue_full_wait}), "waiting for room"},
      {share(result, {Activity::lock_wait}), "waiting for parts of the tree"},
      {on_memory(result), "on memory"}};
  const auto* const most = std::max_element(waits.begin(), waits.end(),
                                            [](const auto& a, const auto& b) { return a.first < b.first; });
  return most->first > computing(result) ? fmt::format(", {:.1f} % {}", 100.0 * most->first, most->second)
                                         : std::string();
}

std::string why_nodes(const std::string& name, const MachineConfig& machine, const MachineResult& result) {
  if (machine.scheme == processors::Scheme::pipeline) {
    for (const StageLoad& stage : flow_figures(machine, result).stages) {
      if (name == "pipeline." + stage.name) {
        return fmt::format("the nodes of this stage are {:.1f} % busy", 100.0 * stage.busy);
      }
    }
  }
  std::string text = fmt::format("nodes spend {:.1f} % of their time computing{}", 100.0 * computing(result),
                                 more_than_computing(result));
  if (result.build.start_up_wait > 0) {
    text += fmt::format(" and {:.1f} % waiting for the initial tree", 100.0 * start_up(result));
  }
  return text;
}

std::string why_network(const MachineConfig& machine, const MachineResult& result) {
  const std::optional<double> busy = machine.scheme == processors::Scheme::image
                                         ? figure_of(machine, result, "interconnect_utilisation")
                                         : flow_figures(machine, result).network;
  return busy ? fmt::format("the network's links are {:.1f} % busy", 100.0 * *busy)
              : std::string("every message takes its latency");
}

std::string why_host(const MachineConfig& machine, const MachineResult& result) {
  if (machine.scheme != processors::Scheme::image) {
    return fmt::format("camera rays keep the host {:.1f} % of the time",
                       100.0 * flow_figures(machine, result).host);
  }
  return fmt::format("nodes spend {:.1f} % of their time waiting for packets",
                     percent(result, {Activity::dispatch_wait}));
}

std::string why_regions(const MachineConfig& machine, const MachineResult& result) {
  const StageLoad all = flow_figures(machine, result).all;
  return fmt::format("the busiest node is {:.1f} % busy, a node on average {:.1f} %", 100.0 * all.busiest,
                     100.0 * all.busy);
}

}  // namespace

double share_of(Part part, const MachineConfig& machine, const MachineResult& result) {
  switch (part) {
    case Part::nodes:
      return computing(result);
    case Part::caches:
    case Part::second_level:
    case Part::local_memory:
      return on_memory(result);
    case Part::interconnect:
      return std::max(share(result, {Activity::interconnect_wait, Activity::transfer}),
                      figure_of(machine, result, "interconnect_utilisation").value_or(0.0));
    case Part::banks:
      return std::max(share(result, {Activity::bank_wait, Activity::bank_access}),
                      figure_of(machine, result, "bank_utilisation").value_or(0.0));
    case Part::network:
      return share(result, {Activity::interconnect_wait, Activity::transfer, Activity::message_wait});
    case Part::messages:
      return share(result, {Activity::messaging, Activity::message_wait});
    case Part::queues:
      return share(result, {Activity::queue_full_wait});
    case Part::host:
      return share(result, {Activity::dispatch_wait});
    case Part::building:
      return share(result, {Activity::building, Activity::lock_wait}) + start_up(result);
    case Part::regions:
      break;
  }
  return share(result, {Activity::idle, Activity::message_wait});
}

std::string why(const Help& help, const MachineConfig& machine, const MachineResult& result) {
  switch (help.part) {
    case Part::nodes:
      return why_nodes(help.name, machine, result);
    case Part::caches:
    case Part::second_level:
      return fmt::format("nodes spend {:.1f} % of their time on misses", 100.0 * on_memory(result));
    case Part::local_memory:
      return fmt::format("nodes spend {:.1f} % of their time on memory", 100.0 * on_memory(result));
    case Part::interconnect:
      if (const std::optional<double> busy = figure_of(machine, result, "interconnect_utilisation")) {
        return fmt::format("the {} is {:.1f} % busy", interconnect_name(machine), 100.0 * *busy);
      }
      return fmt::format("nodes spend {:.1f} % of their time on transfers",
                         percent(result, {Activity::transfer}));
    case Part::banks:
      return fmt::format("the busiest bank is {:.1f} % busy",
                         100.0 * figure_of(machine, result, "bank_utilisation").value_or(0.0));
    case Part::network:
      return why_network(machine, result);
    case Part::messages:
      return fmt::format("nodes spend {:.1f} % of their time on messages and {:.1f} % waiting for rays",
                         percent(result, {Activity::messaging}), percent(result, {Activity::message_wait}));
    case Part::queues:
      return fmt::format("nodes spend {:.1f} % of their time waiting for room",
                         percent(result, {Activity::queue_full_wait}));
    case Part::host:
      return why_host(machine, result);
    case Part::building:
      return fmt::format("nodes spend {:.1f} % of their time building or waiting for parts of the tree",
                         100.0 * share_of(help.part, machine, result));
    case Part::regions:
      break;
  }
  return why_regions(machine, result);
}

}  // namespace marti::studies
