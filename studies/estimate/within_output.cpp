#include "studies/estimate/within_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "studies/estimate/simulator_methods.h"
#include "studies/show/json_parts.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"
#include "studies/version.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

// Both ends of a figure's interval: infinite where nothing bounds it, NaN where the error is not known.
std::pair<double, double> interval(Figure figure, double value, double half_width) {
  if (!std::isfinite(half_width)) {
    return {NAN, NAN};
  }
  if (figure == Figure::use) {
    return {std::max(0.0, value - half_width), std::min(1.0, value + half_width)};
  }
  return {value / (1.0 + half_width), half_width < 1.0 ? value / (1.0 - half_width) : HUGE_VAL};
}

// A figure with its half-width in percent and its interval; `text` writes a value.
template <class Text>
std::string bar(const Estimate& estimate, Figure figure, const Text& text, const char* unbounded) {
  const double value = estimate.value[figure];
  const double half_width = estimate.half_width[figure];
  if (!std::isfinite(half_width)) {
    return fmt::format("{:<14}error not known\n", text(value));
  }
  const auto [low, high] = interval(figure, value, half_width);
  return fmt::format("{:<14}+- {:<8} {} to {}\n", text(value), fmt::format("{:.2g} %", 100.0 * half_width),
                     text(low), std::isfinite(high) ? text(high) : unbounded);
}

std::string time_bar(const Estimate& estimate, Figure figure) {
  return bar(
      estimate, figure, [](double ticks) { return seconds(std::llround(ticks)); }, "any time");
}

std::string number_bar(const Estimate& estimate, Figure figure, int digits) {
  return bar(
      estimate, figure, [digits](double number) { return fmt::format("{:.{}f}", number, digits); },
      "any number");
}

// A figure in percent, with its half-width in points.
std::string points_bar(double percent, double half_width, std::string_view what) {
  const std::string value = fmt::format("{:.2f} %{}", percent, what);
  return std::isfinite(half_width) ? fmt::format("{:<14}+- {:.2g} points\n", value, half_width)
                                   : fmt::format("{:<14}error not known\n", value);
}

Json figures_json(const Estimate& estimate, bool with_speed_up) {
  Json figures = Json::object();
  for (std::size_t i = 0; i < figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    if (figure == Figure::speed_up && !with_speed_up) {
      continue;
    }
    const double value = estimate.value[figure];
    const double half_width = estimate.half_width[figure];
    const auto [low, high] = interval(figure, value, half_width);
    figures[std::string(figure_names[i])] = {
        {"value", value}, {"half_width", half_width}, {"low", low}, {"high", high}};
  }
  return figures;
}

}  // namespace

std::string estimate_text(const RunResult& result, const EstimatedRun& run, double tolerance) {
  const Method& method = simulator_methods()[run.method];
  const MachineFigures& value = run.machine.value;
  const MachineFigures& half = run.machine.half_width;
  const double share =
      run.machine.references > 0.0 ? 100.0 * value[Figure::misses] / run.machine.references : 0.0;
  const std::uint32_t nodes = result.machine.nodes;
  std::string text = scene_summary_of(result);
  text += fmt::format(
      "\nestimate      {}, {}: not exact, asked for within {:g} %\n"
      "rests on      errors that `marti study error` measured against exact replay on machines of up to {} "
      "nodes with the bus and the banks of configs/error.toml, of which 95 % are covered{}\n\n",
      method.name(), method.knob(), 100.0 * tolerance, run.nodes_to,
      method.kind == MethodKind::sampled ? ", and the spread of this run's own sample" : "");
  text += "frame time    " + time_bar(run.machine, Figure::end);
  text += fmt::format("speed-up      {}", number_bar(run.machine, Figure::speed_up, 2));
  text += fmt::format("  on {} node{}\n", nodes, nodes == 1 ? "" : "s");
  text += "one node      " + time_bar(run.one_node, Figure::end);
  text += "misses        " + number_bar(run.machine, Figure::misses, 0);
  text += "hit ratio     " + points_bar(100.0 - share, share * half[Figure::misses], "");
  text += "interconnect  " + points_bar(100.0 * value[Figure::use], 100.0 * half[Figure::use], " busy");
  text += "mean wait     " + time_bar(run.machine, Figure::wait);
  text += "\nall other figures need an exact replay: run without --within\n";
  return text;
}

std::string estimate_json(const RunResult& result, const EstimatedRun& run, double tolerance) {
  const Method& method = simulator_methods()[run.method];
  const Json json = {{"marti", {{"version", version}}},
                     {"config", config_json(result.config_name, result.values)},
                     {"estimate",
                      {{"method", method.name()},
                       {"knob", method.knob()},
                       {"tolerance", tolerance},
                       {"measured_nodes_to", run.nodes_to},
                       {"nodes", result.machine.nodes},
                       {"references", run.machine.references},
                       {"machine", figures_json(run.machine, true)},
                       {"one_node", figures_json(run.one_node, false)}}}};
  return json_text(json);
}

}  // namespace marti::studies
