#include "studies/figures/scaling.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "processors/node/memory_system.h"
#include "studies/figures/flow_figures.h"

namespace marti::studies {

using processors::Activity;

namespace {

// Waits for a part that is always busy are named if they take at least this share of the nodes' time.
constexpr double worth_naming = 0.1;

double share(sim::Ticks part, double whole) { return whole > 0.0 ? static_cast<double>(part) / whole : 0.0; }

// Whether space is cut into fewer regions than a cluster has nodes.
bool few_regions(const processors::MachineConfig& machine, const processors::MachineResult& result) {
  return machine.scheme == processors::Scheme::space && result.flow.regions < machine.nodes;
}

std::string more_regions(const processors::MachineConfig& machine, const processors::MachineResult& result) {
  return fmt::format("a higher space.level ({} region(s) for {} nodes)", result.flow.regions, machine.nodes);
}

std::string describe(Limit limit, double part, const Utilisation& used,
                     const processors::MachineConfig& machine, const processors::MachineResult& result) {
  const double percent = 100.0 * part;
  const bool distributed = machine.placement == processors::Placement::distributed;
  const bool bus = !distributed && machine.interconnect.kind == memory::InterconnectKind::bus;
  switch (limit) {
    case Limit::nothing:
      return "nothing to do";
    case Limit::interconnect:
      return fmt::format(
          "the {} is {:.1f} % busy and nodes spend {:.1f} % of their time waiting for it; fewer misses "
          "(larger cache), a wider {} or more clusters would help",
          interconnect_name(machine), 100.0 * used.interconnect.value_or(0.0), percent, bus ? "bus" : "link");
    case Limit::bank:
      if (distributed) {
        return fmt::format(
            "the busiest node's memory is {:.1f} % busy and nodes spend {:.1f} % of their time waiting for "
            "each other's memories; fewer misses (larger cache), faster memories or another "
            "database.interleave would help",
            100.0 * used.bank, percent);
      }
      return fmt::format(
          "the busiest bank is {:.1f} % busy and nodes spend {:.1f} % of their time waiting for banks; more "
          "or "
          "faster banks would help",
          100.0 * used.bank, percent);
    case Limit::memory_latency:
      return fmt::format(
          "memory latency: nodes spend {:.1f} % of their time on transfers and bank accesses that meet no "
          "queue; fewer misses or {} would help",
          percent, distributed ? "a faster network" : "faster memory");
    case Limit::dispatch:
      if (machine.scheme != processors::Scheme::image) {
        return fmt::format(
            "the host: camera rays keep it {:.1f} % of the time, and nodes spend {:.1f} % of theirs waiting; "
            "fewer "
            "host.occupancy_cycles would help",
            100.0 * flow_figures(machine, result).host, percent);
      }
      return fmt::format(
          "the host: nodes spend {:.1f} % of their time waiting for packets; larger packets would help",
          percent);
    case Limit::start_up:
      return fmt::format(
          "building before the frame: nodes wait {:.1f} % of their time for the initial tree; {} would help",
          percent,
          machine.build.sharing == processors::Sharing::none
              ? "building on demand (build.sharing = \"shared\" or \"private\")"
              : "a lower build.initial_level");
    case Limit::lock:
      return fmt::format(
          "locks: nodes spend {:.1f} % of their time waiting for branches that others split; a higher "
          "build.initial_level would help",
          percent);
    case Limit::imbalance:
      if (machine.scheme != processors::Scheme::image) {
        return fmt::format("imbalance: nodes are idle {:.1f} % of the time; {} would help", percent,
                           few_regions(machine, result) ? more_regions(machine, result)
                                                        : "more rays in flight, or fewer nodes,");
      }
      return fmt::format(
          "imbalance: nodes are idle {:.1f} % of the time, {} packet(s) for {} nodes; smaller packets would "
          "help",
          percent, result.packets, result.nodes.size());
    case Limit::slowest_part: {
      const FlowFigures figures = flow_figures(machine, result);
      const StageLoad& slowest = figures.slowest();
      if (figures.stages.empty()) {
        return fmt::format(
            "imbalance: the busiest node is {:.1f} % busy, a node on average {:.1f} %, and nodes spend "
            "{:.1f} % of their time waiting for rays and queues; {} would help",
            100.0 * slowest.busiest, 100.0 * slowest.busy, percent,
            few_regions(machine, result) ? more_regions(machine, result)
                                         : "a division that is better balanced");
      }
      return fmt::format(
          "the slowest stage: {} is {:.1f} % busy, and nodes spend {:.1f} % of their time waiting for rays "
          "and queues; more of the nodes in pipeline.{} would help",
          slowest.name, 100.0 * slowest.busy, percent, slowest.name);
    }
    case Limit::queues:
      return fmt::format(
          "full queues: nodes spend {:.1f} % of their time waiting for room in another's queue; longer "
          "queues would help",
          percent);
    case Limit::messages: {
      const FlowFigures figures = flow_figures(machine, result);
      if (bottleneck_of(machine, result) == Bottleneck::network) {
        const bool host = figures.host_link > figures.network.value_or(0.0);
        return fmt::format(
            "messages: {} {:.1f} % busy, and nodes spend {:.1f} % of their time waiting for rays; a wider or "
            "faster network or smaller messages would help",
            host ? "the link to the host is" : "the network's links are",
            100.0 * (host ? figures.host_link : figures.network.value_or(0.0)), percent);
      }
      return fmt::format(
          "messages: nodes spend {:.1f} % of their time waiting for rays; links are {:.1f} % busy and {} "
          "rays were in flight at most; a faster network or more rays in flight would help",
          percent, 100.0 * figures.network.value_or(0.0), result.flow.most_in_flight);
    }
    case Limit::write_buffer:
      return fmt::format("full write buffers: nodes spend {:.1f} % of their time on them", percent);
    case Limit::compute:
      break;
  }
  return fmt::format("computing: nodes spend {:.1f} % of their time on it; more or faster nodes would help",
                     percent);
}

}  // namespace

std::string interconnect_name(const processors::MachineConfig& machine) {
  if (machine.placement == processors::Placement::distributed) {
    const auto kind = static_cast<std::size_t>(machine.network.kind);
    return std::string(memory::network_kind_names[kind]) + " network";
  }
  switch (machine.interconnect.kind) {
    case memory::InterconnectKind::ideal:
      return "ideal interconnect";
    case memory::InterconnectKind::crossbar:
      return "crossbar";
    case memory::InterconnectKind::bus:
      break;
  }
  return "bus";
}

Scaling scaling_of(sim::Ticks one_node_end, sim::Ticks end, std::uint32_t nodes) {
  Scaling scaling;
  scaling.nodes = nodes;
  scaling.one_node_end = one_node_end;
  if (end > 0 && one_node_end > 0) {
    const double n = nodes;
    const double s = static_cast<double>(one_node_end) / static_cast<double>(end);
    scaling.speed_up = s;
    scaling.efficiency = s / n;
    if (nodes > 1) {
      scaling.serial_fraction = (1.0 / s - 1.0 / n) / (1.0 - 1.0 / n);
    }
  }
  return scaling;
}

Utilisation utilisation_of(const processors::MachineConfig& machine,
                           const processors::MachineResult& result) {
  Utilisation used;
  std::int64_t banks = 0;
  double busy = 0.0;
  const double end = static_cast<double>(result.end);
  for (const processors::ClusterResult& cluster : result.clusters) {
    if (processors::has_links(machine)) {
      const double links = static_cast<double>(cluster.interconnect.links);
      used.interconnect =
          std::max(used.interconnect.value_or(0.0), share(cluster.interconnect.busy, end * links));
    }
    for (const memory::BankStatistics& bank : cluster.banks) {
      // A bank that is still recovering when the frame ends counts as busy until then.
      const double utilisation = std::min(1.0, share(bank.busy, end));
      used.bank = std::max(used.bank, utilisation);
      busy += utilisation;
      ++banks;
    }
  }
  used.mean_bank = banks > 0 ? busy / static_cast<double>(banks) : 0.0;
  return used;
}

Finding find_limit(const processors::MachineConfig& machine, const processors::MachineResult& result) {
  if (result.end == 0) {
    return {Limit::nothing, 0.0, "nothing: the frame takes no time on this machine"};
  }
  const processors::TimeDivision time = result.time();
  const auto part = [&](std::initializer_list<Activity> parts) {
    return std::accumulate(parts.begin(), parts.end(), 0.0, [&](double sum, Activity activity) {
      return sum + static_cast<double>(time[static_cast<std::size_t>(activity)]);
    });
  };
  const FlowWaits waits = flow_waits(machine, result);
  const std::array<std::pair<Limit, double>, 12> candidates = {{
      {Limit::interconnect, part({Activity::interconnect_wait})},
      {Limit::bank, part({Activity::bank_wait})},
      {Limit::memory_latency, part({Activity::transfer, Activity::bank_access})},
      {Limit::dispatch, part({Activity::dispatch_wait}) - static_cast<double>(result.build.start_up_wait)},
      {Limit::start_up, static_cast<double>(result.build.start_up_wait)},
      {Limit::lock, part({Activity::lock_wait})},
      {Limit::imbalance, part({Activity::idle})},
      {Limit::write_buffer,
       machine.scheme == processors::Scheme::image ? part({Activity::queue_full_wait}) : 0.0},
      {Limit::slowest_part, waits.slowest},
      {Limit::queues, waits.queues},
      {Limit::messages, waits.messages},
      {Limit::compute,
       part({Activity::traversal, Activity::intersection, Activity::shading, Activity::building,
             Activity::cache_access, Activity::switching, Activity::messaging})},
  }};
  const auto* const largest = std::max_element(
      candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const double all = static_cast<double>(result.end) * static_cast<double>(result.nodes.size());
  Finding finding;
  finding.limit = largest->first;
  finding.share = largest->second / all;
  const double flow = waits.slowest + waits.queues + waits.messages;
  if (machine.scheme != processors::Scheme::image && flow >= worth_naming * all) {
    // A resource that is always busy bounds the frame even if the nodes spend more time on something else.
    // First come shared resources, then the slowest part, whose nodes may be busy waiting for a shared
    // resource.
    const Bottleneck bottleneck = bottleneck_of(machine, result);
    if (utilisation_of(machine, result).interconnect.value_or(0.0) >= full) {
      finding = {Limit::interconnect, part({Activity::interconnect_wait}) / all, ""};
    } else if (bottleneck != Bottleneck::none) {
      finding = {bottleneck == Bottleneck::host ? Limit::dispatch : Limit::messages, flow / all, ""};
    } else if (waits.slowest >= worth_naming * all) {
      finding = {Limit::slowest_part, waits.slowest / all, ""};
    }
  }
  finding.sentence = describe(finding.limit, finding.share, utilisation_of(machine, result), machine, result);
  return finding;
}

std::string_view name_of(Limit limit) {
  switch (limit) {
    case Limit::nothing:
      return "nothing";
    case Limit::interconnect:
      return "interconnect";
    case Limit::bank:
      return "bank";
    case Limit::memory_latency:
      return "memory_latency";
    case Limit::dispatch:
      return "dispatch";
    case Limit::start_up:
      return "start_up";
    case Limit::lock:
      return "lock";
    case Limit::imbalance:
      return "imbalance";
    case Limit::write_buffer:
      return "write_buffer";
    case Limit::slowest_part:
      return "slowest_part";
    case Limit::queues:
      return "queues";
    case Limit::messages:
      return "messages";
    case Limit::compute:
      break;
  }
  return "compute";
}

}  // namespace marti::studies
