#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "sim/statistics.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

nlohmann::ordered_json context_json(const run::RunResult& r) {
  if (r.timed.contexts.nodes.empty()) {
    return nullptr;
  }
  return {{"contexts", r.machine.contexts}, {"per_node", counters_list(r.timed.contexts.nodes)}};
}

std::string context_lines(const run::RunResult& r) {
  std::string text;
  if (r.timed.contexts.nodes.empty()) {
    return text;
  }
  const auto out = std::back_inserter(text);
  if (r.machine.contexts > 1) {
    fmt::format_to(out, "contexts      {} a node, {} switches, {} waits for a line that another fetched\n",
                   r.machine.contexts, tables::grouped(r.count("contexts_switches")),
                   tables::grouped(r.count("contexts_joined")));
  }
  if (r.machine.prefetch.on()) {
    const std::optional<double> useful = sim::ratio(r.count("contexts_useful"), r.count("contexts_issued"));
    fmt::format_to(out, "prefetch      {} lines, {} of them useful, {} waits for one under way, {} dropped\n",
                   tables::grouped(r.count("contexts_issued")), useful ? tables::percent(*useful) : "-",
                   tables::grouped(r.count("contexts_late")), tables::grouped(r.count("contexts_dropped")));
  }
  return text;
}

}  // namespace marti::studies::show
