#include "studies/show/build_output.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "sim/statistics.h"
#include "studies/show/json_parts.h"

namespace marti::studies {

nlohmann::ordered_json build_json(const processors::BuildResult& build, bool per_node) {
  return {{"sharing", processors::sharing_names[static_cast<std::size_t>(build.sharing)]},
          {"levels", counters_list(build.levels)},
          {"per_node", counters_list(build.nodes, per_node)}};
}

std::string build_lines(const processors::MachineResult& result) {
  const processors::BuildResult& build = result.build;
  std::string text;
  if (build.sharing == processors::Sharing::given) {
    return text;
  }
  const auto out = std::back_inserter(text);
  const processors::BuildCounts counts = build.counts();
  const processors::BuildLevel all = build.all_levels();
  fmt::format_to(out,
                 "\nbuilding      {} before the frame, {:.2f} % of its time; {} during it, {} lock waits",
                 counts.start_up_splits, 100.0 * sim::ratio(build.start_up, result.end).value_or(0.0),
                 counts.splits, counts.waits);
  if (build.wasted_splits() != 0) {
    fmt::format_to(out, ", {} made more than once", build.wasted_splits());
  }
  fmt::format_to(out, "\n  {:<6}{:>10}{:>10}{:>10}{:>12}{:>12}{:>12}{:>14}\n", "level", "branches", "leaves",
                 "partial", "node bytes", "list bytes", "released", "visits");
  const auto line = [&](const std::string& name, const processors::BuildLevel& level) {
    fmt::format_to(out, "  {:<6}{:>10}{:>10}{:>10}{:>12}{:>12}{:>12}{:>14}\n", name, level.branches,
                   level.leaves, level.partial, level.node_bytes, level.list_bytes, level.released_bytes,
                   level.visits);
  };
  for (std::size_t level = 0; level < build.levels.size(); ++level) {
    line(std::to_string(level + 1), build.levels[level]);
  }
  line("all", all);
  return text;
}

}  // namespace marti::studies
