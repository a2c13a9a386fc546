// What `marti run --within` says when it has estimated: for people, and for programs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "studies/estimate/within.h"
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

const std::string unknown = "error not known";

std::string line(std::string_view name, std::string_view value, std::string_view error) {
  return fmt::format("{:<13} {:<13} {}\n", name, value, error);
}

// A figure with its half-width in percent and its interval; `text` writes a value.
template <class Text>
std::string bar(std::string_view name, const Estimate& estimate, Figure figure, const Text& text,
                std::string unbounded) {
  const double half_width = estimate.half_width[figure];
  const auto [low, high] = interval(estimate, figure);
  return line(name, text(estimate.value[figure]),
              !std::isfinite(half_width)
                  ? unknown
                  : fmt::format("+- {:<8} {} to {}",
                                fmt::format("{:.{}g} %", 100.0 * half_width, half_width < 1.0 ? 2 : 3),
                                text(low), std::isfinite(high) ? text(high) : unbounded));
}

std::string time_bar(std::string_view name, const Estimate& estimate, Figure figure) {
  const auto text = [](double ticks) { return tables::seconds(std::llround(ticks)); };
  return bar(name, estimate, figure, text, "any time");
}

// Misses, and the share of references that do not miss, with the interval that the misses leave it.
std::string misses_and_hits(const Estimate& estimate) {
  const auto count = [](double number) { return tables::grouped(std::llround(std::min(number, 0x1p62))); };
  const auto ratio = [&](double misses) {
    const double hits = std::max(0.0, 1.0 - misses / std::max(1.0, estimate.references));
    return fmt::format("{:.2f} %", 100.0 * hits);
  };
  const std::string value = ratio(estimate.value[Figure::misses]);
  const auto [fewest, most] = interval(estimate, Figure::misses);
  return bar("misses", estimate, Figure::misses, count, "any number") +
         (std::isnan(fewest) ? line("hit ratio", value, unknown)
                             : line("hit ratio", fmt::format("{:<25}", value),
                                    fmt::format("{} to {}", ratio(most), ratio(fewest))));
}

Json figures_json(const Estimate& estimate, bool with_speed_up) {
  Json figures = Json::object();
  for (std::size_t i = 0; i < figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    if (figure != Figure::speed_up || with_speed_up) {
      const auto [low, high] = interval(estimate, figure);
      figures[std::string(figure_names[i])] = {{"value", estimate.value[figure]},
                                               {"half_width", estimate.half_width[figure]},
                                               {"low", low},
                                               {"high", high}};
    }
  }
  return figures;
}

}  // namespace

std::string estimate_text(const run::RunResult& result, const EstimatedRun& run, double tolerance) {
  const Estimate& machine = run.sampled.machine;
  const TracedPart& traced = run.traced;
  const processors::program::LogTotals& part = result.functional.totals;
  const double points = 100.0 * machine.half_width[Figure::use];
  const auto two_digits = [](double number) { return fmt::format("{:.2f}", number); };
  return show::scene_summary_of(result) +
         fmt::format("image         {}, about {} rays\n", keys::size_text(result.frame_config.render),
                     tables::grouped(static_cast<std::uint64_t>(std::llround(traced.rays)))) +
         fmt::format(
             "left out      {:.1f} % of the pixels, with about {:.1f} % of the rays and {} of work log: {} "
             "windows of {} are traced and timed, {} of {} packets, and of all others one pixel in 64\n",
             100.0 * (1.0 - traced.pixels),
             100.0 * std::max(0.0, 1.0 - static_cast<double>(part.all_rays()) / traced.rays),
             tables::bytes(std::max(0.0, traced.log_bytes - static_cast<double>(part.bytes))), run.windows,
             run.of_windows, tables::grouped(run.packets), tables::grouped(run.of_packets)) +
         fmt::format(
             "\nestimate      not exact, asked for within {:g} %: 95 % intervals, by the spread of this "
             "sample and errors that were measured on machines whose interconnect is busy up to {:g} % of "
             "the frame\n\n",
             100.0 * tolerance, 100.0 * run.use_to) +
         time_bar("frame time", machine, Figure::end) +
         bar("speed-up", machine, Figure::speed_up, two_digits, "any number") +
         fmt::format("  on {}\n", tables::counted(result.machine.nodes, "node")) +
         time_bar("one node", run.sampled.one_node, Figure::end) + misses_and_hits(machine) +
         line("interconnect", fmt::format("{:.2f} % busy", 100.0 * machine.value[Figure::use]),
              std::isfinite(points) ? fmt::format("+- {:.2g} points", points) : unknown) +
         time_bar("mean wait", machine, Figure::wait) +
         "\nall other figures need an exact run, without --within\n";
}

std::string estimate_json(const run::RunResult& result, const EstimatedRun& run, double tolerance) {
  return tables::json_text(Json{{"marti", {{"version", version}}},
                                {"config", keys::config_json(result.config_name, result.values)},
                                {"estimate",
                                 {{"tolerance", tolerance},
                                  {"use_to", run.use_to},
                                  {"windows", run.windows},
                                  {"of_windows", run.of_windows},
                                  {"packets", run.packets},
                                  {"of_packets", run.of_packets},
                                  {"traced_pixels", run.traced.pixels},
                                  {"rays", run.traced.rays},
                                  {"nodes", result.machine.nodes},
                                  {"references", run.sampled.machine.references},
                                  {"machine", figures_json(run.sampled.machine, true)},
                                  {"one_node", figures_json(run.sampled.one_node, false)}}}});
}

}  // namespace marti::studies::estimate
