#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "processors/flow/pipeline/stages.h"
#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;
using processors::path::CriticalPath;

std::string share(sim::Ticks part, sim::Ticks whole) {
  return whole == 0 ? "-" : tables::percent(static_cast<double>(part) / static_cast<double>(whole));
}

sim::Ticks own_work(const CriticalPath& path) {
  sim::Ticks own = 0;
  for (std::size_t kind = 0; kind < processors::path::path_kinds; ++kind) {
    own += processors::path::is_own_work(static_cast<processors::path::PathKind>(kind)) ? path.time[kind] : 0;
  }
  return own;
}

// Of a pipeline: the time on the path of the nodes of each stage; else none.
std::vector<sim::Ticks> of_stages(const run::RunResult& result) {
  const processors::machine::MachineConfig& machine = result.machine;
  if (machine.scheme != processors::machine::Scheme::pipeline) {
    return {};
  }
  std::vector<sim::Ticks> stages(processors::machine::pipeline_stages);
  for (std::size_t node = 0; node < result.critical_path->nodes.size(); ++node) {
    const auto port = static_cast<std::uint32_t>(node % machine.nodes);
    stages[static_cast<std::size_t>(processors::flow::stage_of_node(machine.pipeline, port))] +=
        result.critical_path->nodes[node];
  }
  return stages;
}

std::string stages_line(const run::RunResult& result) {
  const std::vector<sim::Ticks> stages = of_stages(result);
  std::string text;
  for (std::size_t stage = 0; stage < stages.size(); ++stage) {
    text += fmt::format("{}{} {}", stage == 0 ? "" : ", ", processors::flow::stage_names[stage],
                        share(stages[stage], result.critical_path->end));
  }
  return text.empty() ? text : fmt::format("  {:<12}{}\n", "by stage", text);
}

}  // namespace

nlohmann::ordered_json critical_path_json(const run::RunResult& result) {
  if (!result.critical_path) {
    return nullptr;
  }
  const CriticalPath& path = *result.critical_path;
  sim::ensure(std::reduce(path.time.begin(), path.time.end()) == result.timed.end &&
                  std::reduce(path.nodes.begin(), path.nodes.end()) == result.timed.end,
              "a critical path does not add up to the frame time");
  Json time = Json::object();
  for (std::size_t kind = 0; kind < processors::path::path_kinds; ++kind) {
    time[std::string(processors::path::path_kind_names[kind])] = path.time[kind];
  }
  const std::vector<sim::Ticks> stages = of_stages(result);
  const Json levels = sim::mapped(path.levels, [&](const processors::path::PathLevel& level) {
    return Json{{"traversal_ps", level.traversal}, {"reads_ps", level.reads}};
  });
  return {{"time_ps", time},
          {"nodes_ps", path.nodes.size() <= most_listed ? Json(path.nodes) : Json(nullptr)},
          {"stages_ps", stages.empty() ? Json(nullptr) : Json(stages)},
          {"levels", levels},
          {"pieces", path.pieces},
          {"node_changes", path.node_changes}};
}

std::string critical_path_lines(const run::RunResult& result) {
  if (!result.critical_path) {
    return {};
  }
  const CriticalPath& path = *result.critical_path;
  std::array<std::size_t, processors::path::path_kinds> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return path.time[a] > path.time[b]; });
  std::string largest;
  for (const std::size_t kind : {order[0], order[1], order[2]}) {
    if (path.time[kind] > 0) {
      largest += fmt::format("{}{} {}", largest.empty() ? "" : ", ", processors::path::path_kind_names[kind],
                             share(path.time[kind], path.end));
    }
  }
  const auto most = std::ranges::max_element(path.nodes);
  return fmt::format(
      "\ncritical path {} pieces, {} of it work of single nodes, from node to node {} times\n"
      "  {:<12}{}\n"
      "  {:<12}node {}, {}\n"
      "{}",
      tables::grouped(path.pieces), share(own_work(path), path.end), tables::grouped(path.node_changes),
      "largest", largest.empty() ? "none" : largest, "most for", most - path.nodes.begin(),
      share(*most, path.end), stages_line(result));
}

}  // namespace marti::studies::show
