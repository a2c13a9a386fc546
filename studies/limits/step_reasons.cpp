#include "studies/limits/step_reasons.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "studies/figures/find_limit.h"
#include "studies/figures/flow_figures.h"

namespace marti::studies::limits {

namespace {

double busy_share(helps::Part part, const PointFigures& figures) {
  if (part == helps::Part::interconnect) {
    return figures.links > 0.0 ? figures.interconnect_busy / (figures.links * figures.end) : 0.0;
  }
  return part == helps::Part::banks ? std::min(1.0, figures.most_bank_busy / figures.end) : 0.0;
}

}  // namespace

bool is_full(helps::Part part, const processors::machine::MachineConfig& machine,
             const PointFigures& figures) {
  const bool ideal = machine.interconnect.kind == memory::InterconnectKind::ideal;
  return !ideal && busy_share(part, figures) >= figures::full;
}

std::string reason_of(helps::Part part, const processors::machine::MachineConfig& machine,
                      const PointFigures& figures) {
  const double all = figures.end * machine.all_nodes();
  const auto text = [&](double time, std::string_view what) {
    return fmt::format("model: {} {:.1f} % of their time", what, 100.0 * time / all);
  };
  const bool ideal = machine.interconnect.kind == memory::InterconnectKind::ideal;
  const std::string basis = is_full(part, machine, figures) ? "bound" : "model";
  if (part == helps::Part::interconnect && !ideal) {
    return fmt::format("{}: the {} is {:.1f} % busy", basis, figures::interconnect_name(machine),
                       100.0 * busy_share(part, figures));
  }
  if (part == helps::Part::banks) {
    return fmt::format("{}: the busiest {} is {:.1f} % busy", basis, figures::bank_name(machine),
                       100.0 * busy_share(part, figures));
  }
  if (part == helps::Part::interconnect) {
    return text(figures.transfer, "transfers take the nodes");
  }
  if (part == helps::Part::host) {
    return text(figures.delays, "nodes wait for packets for");
  }
  return text(figures.computing + figures.cache_access, "nodes compute for");
}

}  // namespace marti::studies::limits
