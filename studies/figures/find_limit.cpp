#include "studies/figures/find_limit.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "studies/figures/derived_figures.h"
#include "studies/figures/flow_figures.h"

namespace marti::studies::figures {

using processors::cost::Activity;

namespace {

// Waits for a part that is always busy are named if they take at least this share of the nodes' time.
constexpr double notable_share = 0.1;

}  // namespace

std::string interconnect_name(const processors::machine::MachineConfig& machine) {
  if (machine.placement == processors::machine::Placement::distributed) {
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

std::string bank_name(const processors::machine::MachineConfig& machine) {
  return machine.banks.dram ? "channel" : "bank";
}

Limit find_limit(const processors::machine::MachineConfig& machine,
                 const processors::replay::MachineResult& result) {
  if (result.end == 0) {
    return Limit::nothing;  // the frame takes no time
  }
  const processors::cost::TimeSums time = result.time();
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
       machine.scheme == processors::machine::Scheme::image ? part({Activity::queue_full_wait}) : 0.0},
      {Limit::slowest_part, waits.slowest},
      {Limit::queues, waits.queues},
      {Limit::messages, waits.messages},
      {Limit::compute,
       processors::cost::sum_of_kinds({processors::cost::ActivityKind::computing},
                                      [&](std::size_t i) { return static_cast<double>(time[i]); })},
  }};
  const auto* const largest = std::ranges::max_element(candidates, {}, &std::pair<Limit, double>::second);
  const double all = static_cast<double>(result.end) * static_cast<double>(result.nodes.size());
  const double flow = waits.slowest + waits.queues + waits.messages;
  if (machine.scheme != processors::machine::Scheme::image && flow >= notable_share * all) {
    // A resource that is always busy bounds the frame even if the nodes spend more time on something else.
    // First come shared resources, then the slowest part, whose nodes may be busy waiting for a shared
    // resource.
    const Bottleneck bottleneck = bottleneck_of(machine, result);
    if (figure_of(machine, result, "interconnect_utilisation").value_or(0.0) >= full) {
      return Limit::interconnect;
    }
    if (bottleneck != Bottleneck::none) {
      return bottleneck == Bottleneck::host ? Limit::dispatch : Limit::messages;
    }
    if (waits.slowest >= notable_share * all) {
      return Limit::slowest_part;
    }
  }
  return largest->first;
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

}  // namespace marti::studies::figures
