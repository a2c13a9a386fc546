#include "studies/show/context_output.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "studies/show/json_parts.h"

namespace marti::studies {

nlohmann::ordered_json context_json(const processors::MachineConfig& machine,
                                    const processors::ContextResult& result, bool per_node) {
  return {{"contexts", machine.contexts}, {"per_node", counters_list(result.nodes, per_node)}};
}

std::string context_lines(const processors::MachineConfig& machine, const processors::ContextResult& result) {
  std::string text;
  if (result.nodes.empty()) {
    return text;
  }
  const auto out = std::back_inserter(text);
  const processors::ContextCounts counts = result.counts();
  if (machine.contexts > 1) {
    fmt::format_to(out, "contexts      {} a node, {} switches, {} waits for a line that another fetched\n",
                   machine.contexts, counts.switches, counts.joined);
  }
  if (machine.prefetch.on()) {
    const double issued = static_cast<double>(counts.issued);
    fmt::format_to(out, "prefetch      {} lines, {} of them useful, {} waits for one under way, {} dropped\n",
                   counts.issued,
                   counts.issued == 0
                       ? "-"
                       : fmt::format("{:.2f} %", 100.0 * static_cast<double>(counts.useful) / issued),
                   counts.late, counts.dropped);
  }
  return text;
}

}  // namespace marti::studies
