#include "studies/show/critical_path_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numeric>

#include "sim/error.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;
using processors::CriticalPath;

std::string share(sim::Ticks part, sim::Ticks whole) {
  return whole == 0 ? "-" : percent(static_cast<double>(part) / static_cast<double>(whole));
}

sim::Ticks own_work(const CriticalPath& path) {
  sim::Ticks own = 0;
  for (std::size_t kind = 0; kind < processors::path_kinds; ++kind) {
    own += processors::is_own_work(static_cast<processors::PathKind>(kind)) ? path.time[kind] : 0;
  }
  return own;
}

}  // namespace

void add_critical_path(const RunResult& result, bool nodes, Json& machine) {
  if (!result.critical_path) {
    return;
  }
  const CriticalPath& path = *result.critical_path;
  sim::ensure(std::reduce(path.time.begin(), path.time.end()) == result.timed.end &&
                  std::reduce(path.nodes.begin(), path.nodes.end()) == result.timed.end,
              "a critical path does not add up to the frame time");
  Json time = Json::object();
  for (std::size_t kind = 0; kind < processors::path_kinds; ++kind) {
    time[std::string(processors::path_kind_names[kind])] = path.time[kind];
  }
  Json levels = Json::array();
  for (const processors::PathLevel& level : path.levels) {
    levels.push_back({{"traversal_ps", level.traversal}, {"reads_ps", level.reads}});
  }
  machine["critical_path"] = {{"time_ps", time},
                              {"nodes_ps", nodes ? Json(path.nodes) : Json(nullptr)},
                              {"levels", levels},
                              {"pieces", path.pieces},
                              {"node_changes", path.node_changes}};
}

std::string critical_path_lines(const RunResult& result) {
  if (!result.critical_path) {
    return {};
  }
  const CriticalPath& path = *result.critical_path;
  std::array<std::size_t, processors::path_kinds> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return path.time[a] > path.time[b]; });
  std::string largest;
  for (const std::size_t kind : {order[0], order[1], order[2]}) {
    if (path.time[kind] > 0) {
      largest += fmt::format("{}{} {}", largest.empty() ? "" : ", ", processors::path_kind_names[kind],
                             share(path.time[kind], path.end));
    }
  }
  const auto most = std::max_element(path.nodes.begin(), path.nodes.end());
  return fmt::format(
      "\ncritical path {} pieces, {} of it work of single nodes, from node to node {} times\n"
      "  {:<12}{}\n"
      "  {:<12}node {}, {}\n",
      grouped(path.pieces), share(own_work(path), path.end), grouped(path.node_changes), "largest",
      largest.empty() ? "none" : largest, "most for", most - path.nodes.begin(), share(*most, path.end));
}

}  // namespace marti::studies
