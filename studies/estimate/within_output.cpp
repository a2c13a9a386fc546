#include "studies/estimate/within_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "studies/keys/setting_value.h"
#include "studies/show/json_parts.h"
#include "studies/show/summary.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"
#include "studies/version.h"

namespace marti::studies::estimate {

namespace {

using Json = nlohmann::ordered_json;

// Both ends of a figure's interval: infinite where nothing bounds it, NaN where the error is not known.
std::pair<double, double> interval(const Estimate& estimate, Figure figure) {
  const double value = estimate.value[figure];
  const double half_width = estimate.half_width[figure];
  if (!std::isfinite(half_width)) {
    return {NAN, NAN};
  }
  if (figure == Figure::use) {
    return {std::max(0.0, value - half_width), std::min(1.0, value + half_width)};
  }
  const double low = value / (1.0 + half_width);
  // A sample misses more than the frame where caches hold lines for long: its nodes have skipped the packets
  // that bring them in.
  return {figure == Figure::misses ? std::min(low, estimate.fewest_misses) : low,
          half_width < 1.0 ? value / (1.0 - half_width) : HUGE_VAL};
}

// A figure with its half-width in percent and its interval; `text` writes a value.
template <class Text>
std::string bar(const Estimate& estimate, Figure figure, const Text& text, const char* unbounded) {
  const double value = estimate.value[figure];
  const double half_width = estimate.half_width[figure];
  if (!std::isfinite(half_width)) {
    return fmt::format("{:<14}error not known\n", text(value));
  }
  const auto [low, high] = interval(estimate, figure);
  const std::string percent = fmt::format("{:.{}g} %", 100.0 * half_width, half_width < 1.0 ? 2 : 3);
  return fmt::format("{:<14}+- {:<8} {} to {}\n", text(value), percent, text(low),
                     std::isfinite(high) ? text(high) : unbounded);
}

std::string time_bar(const Estimate& estimate, Figure figure) {
  return bar(
      estimate, figure, [](double ticks) { return tables::seconds(std::llround(ticks)); }, "any time");
}

std::string number_bar(const Estimate& estimate, Figure figure, int digits) {
  return bar(
      estimate, figure,
      [digits](double number) {
        return digits == 0 ? tables::grouped(std::llround(std::min(number, 0x1p62)))
                           : fmt::format("{:.{}f}", number, digits);
      },
      "any number");
}

// The share of references that do not miss, with the interval that the misses leave it.
std::string hit_ratio_bar(const Estimate& estimate) {
  const double all = std::max(1.0, estimate.references);
  const auto ratio = [all](double misses) { return 100.0 * std::max(0.0, 1.0 - misses / all); };
  const std::string value = fmt::format("{:.2f} %", ratio(estimate.value[Figure::misses]));
  const auto [fewest, most] = interval(estimate, Figure::misses);
  return std::isnan(fewest) ? fmt::format("{:<14}error not known\n", value)
                            : fmt::format("{:<26}{:.2f} % to {:.2f} %\n", value, ratio(most), ratio(fewest));
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
    const auto [low, high] = interval(estimate, figure);
    figures[std::string(figure_names[i])] = {{"value", estimate.value[figure]},
                                             {"half_width", estimate.half_width[figure]},
                                             {"low", low},
                                             {"high", high}};
  }
  return figures;
}

}  // namespace

std::string estimate_text(const run::RunResult& result, const EstimatedRun& run, const TracedPart& traced,
                          double tolerance) {
  const Estimate& machine = run.sampled.machine;
  const MachineFigures& value = machine.value;
  const MachineFigures& half = machine.half_width;
  const std::uint32_t nodes = result.machine.nodes;
  const processors::program::LogTotals& part = result.functional.totals;
  std::string text = show::scene_summary_of(result);
  text += fmt::format("image         {} x {}, about {} rays\n", result.frame_config.render.width,
                      result.frame_config.render.height,
                      tables::grouped(static_cast<std::uint64_t>(std::llround(traced.rays))));
  text += fmt::format(
      "left out      {:.1f} % of the pixels, with about {:.1f} % of the rays and {} of work log: {} windows "
      "of {} are traced and timed, {} of {} packets, and of all others one pixel in 64\n",
      100.0 * (1.0 - traced.pixels),
      100.0 * std::max(0.0, 1.0 - static_cast<double>(part.all_rays()) / traced.rays),
      tables::bytes(std::max(0.0, traced.log_bytes - static_cast<double>(part.bytes))), run.windows,
      run.of_windows, tables::grouped(run.packets), tables::grouped(run.of_packets));
  text += fmt::format(
      "\nestimate      not exact, asked for within {:g} %: 95 % intervals, by the spread of this sample and "
      "errors that `marti study error` measured on machines whose interconnect is busy up to {:g} % of the "
      "frame\n\n",
      100.0 * tolerance, 100.0 * run.use_to);
  text += "frame time    " + time_bar(machine, Figure::end);
  text += fmt::format("speed-up      {}", number_bar(machine, Figure::speed_up, 2));
  text += fmt::format("  on {}\n", tables::counted(nodes, "node"));
  text += "one node      " + time_bar(run.sampled.one_node, Figure::end);
  text += "misses        " + number_bar(machine, Figure::misses, 0);
  text += "hit ratio     " + hit_ratio_bar(machine);
  text += "interconnect  " + points_bar(100.0 * value[Figure::use], 100.0 * half[Figure::use], " busy");
  text += "mean wait     " + time_bar(machine, Figure::wait);
  text += "\nall other figures need an exact run, without --within\n";
  return text;
}

std::string estimate_json(const run::RunResult& result, const EstimatedRun& run, const TracedPart& traced,
                          double tolerance) {
  const Json json = {{"marti", {{"version", version}}},
                     {"config", keys::config_json(result.config_name, result.values)},
                     {"estimate",
                      {{"tolerance", tolerance},
                       {"use_to", run.use_to},
                       {"windows", run.windows},
                       {"of_windows", run.of_windows},
                       {"packets", run.packets},
                       {"of_packets", run.of_packets},
                       {"traced_pixels", traced.pixels},
                       {"rays", traced.rays},
                       {"nodes", result.machine.nodes},
                       {"references", run.sampled.machine.references},
                       {"machine", figures_json(run.sampled.machine, true)},
                       {"one_node", figures_json(run.sampled.one_node, false)}}}};
  return tables::json_text(json);
}

}  // namespace marti::studies::estimate
