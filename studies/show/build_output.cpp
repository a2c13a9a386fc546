#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "sim/statistics.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/show/text_columns.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

nlohmann::ordered_json build_json(const run::RunResult& r) {
  const processors::node::BuildResult& build = r.timed.build;
  if (build.sharing == processors::machine::Sharing::given) {
    return nullptr;
  }
  return {{"sharing", processors::machine::sharing_names[static_cast<std::size_t>(build.sharing)]},
          {"levels", counters_list(build.levels)},
          {"per_node", counters_list(build.nodes)}};
}

std::string build_lines(const run::RunResult& r) {
  const processors::node::BuildResult& build = r.timed.build;
  std::string text;
  if (build.sharing == processors::machine::Sharing::given) {
    return text;
  }
  fmt::format_to(std::back_inserter(text),
                 "\nbuilding      {} before the frame, {} of its time; {} during it, {} lock waits",
                 tables::grouped(r.count("build_start_up_splits")),
                 tables::percent(sim::ratio(r.count("build_start_up"), r.count("end")).value_or(0.0)),
                 tables::grouped(r.count("build_splits")), tables::grouped(r.count("build_waits")));
  if (const std::int64_t wasted = r.count("build_wasted_splits"); wasted != 0) {
    text += fmt::format(", {} made more than once", tables::grouped(wasted));
  }
  const TextColumns table = {8, {10, 10, 10, 12, 12, 12, 14}};
  text += "\n" + table.row("  level", {"branches", "leaves", "partial", "node bytes", "list bytes",
                                       "released", "visits"});
  const auto line = [&](const std::string& name, const processors::node::BuildLevel& level) {
    std::vector<std::string> cells;
    for (const std::int64_t count : {level.branches, level.leaves, level.partial, level.node_bytes,
                                     level.list_bytes, level.released_bytes, level.visits}) {
      cells.push_back(std::to_string(count));
    }
    text += table.row("  " + name, cells);
  };
  for (std::size_t level = 0; level < build.levels.size(); ++level) {
    line(std::to_string(level + 1), build.levels[level]);
  }
  line("all", r.counters<processors::node::BuildLevel>("tree_"));
  return text;
}

}  // namespace marti::studies::show
