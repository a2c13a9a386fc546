#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sim/mapped.h"
#include "studies/compare/compare_text.h"
#include "studies/compare/two_sweeps.h"
#include "studies/compare/verdict.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

using Json = nlohmann::ordered_json;

std::string whose_points(const char* whose, const std::vector<std::int64_t>& points, bool all) {
  if (points.empty()) {
    return {};
  }
  const std::size_t shown = all ? points.size() : std::min(points.size(), most_lines);
  std::string text = fmt::format("  only in {}: point{}", whose, points.size() == 1 ? "" : "s");
  for (std::size_t i = 0; i < shown; ++i) {
    text += (i == 0 ? " " : ", ") + std::to_string(points[i]);
  }
  return text + (shown < points.size() ? fmt::format(" and {} more\n", points.size() - shown) : "\n");
}

std::string point_lines(const TwoSweeps& found, bool all) {
  std::string text;
  const auto out = std::back_inserter(text);
  const auto line = [&](const auto& a, const auto& b, const std::string& end_a, const std::string& end_b,
                        const std::string& ratio, const std::string& name) {
    fmt::format_to(out, "  {:>7}  {:>7}  {:>11}  {:>11}  {:>9}  {}\n", a, b, end_a, end_b, ratio, name);
  };
  line("A", "B", "A takes", "B takes", "B / A", "point of A");
  const std::size_t shown = all ? found.points.size() : std::min(found.points.size(), most_lines);
  for (std::size_t i = 0; i < shown; ++i) {
    const JoinedPoint& point = found.points[i];
    line(point.a, point.b, tables::seconds(point.end_a), tables::seconds(point.end_b),
         point.same_frame ? fmt::format("{:.4f}", point.ratio()) : "frames", point.name);
  }
  return text + and_more(shown, found.points.size());
}

std::string time_lines(const TwoSweeps& found) {
  std::string text = "\n  mean change of a node's time, of A's frame\n";
  for (const MeanChange& time : found.times) {
    text += fmt::format("  {:<20}{:>12}\n", time.activity, tables::signed_percent(time.of_frame));
  }
  return text;
}

std::string counter_lines(const TwoSweeps& found, bool all) {
  std::string text =
      fmt::format("\n  {:<32}{:>9}  the largest difference, at points of A and B\n", "counter", "points");
  const auto out = std::back_inserter(text);
  const std::size_t shown = all ? found.differing.size() : std::min(found.differing.size(), most_lines);
  for (std::size_t i = 0; i < shown; ++i) {
    const CounterDifference& counter = found.differing[i];
    const std::string unit = unit_of_figure(counter.largest.name);
    fmt::format_to(out, "  {:<32}{:>9}  {:>11}  {} to {}, at {} and {}\n", counter.largest.name,
                   counter.points, change_of(counter.largest),
                   tables::figure_text(counter.largest.a, unit, "-"),
                   tables::figure_text(counter.largest.b, unit, "-"), counter.a, counter.b);
  }
  return text + and_more(shown, found.differing.size());
}

// How many comparable points are faster in B, equal, slower.
std::string balance(const TwoSweeps& found) {
  std::size_t faster = 0;
  std::size_t slower = 0;
  for (std::size_t i = 0; i < found.comparable(); ++i) {
    faster += found.points[i].end_b < found.points[i].end_a ? 1 : 0;
    slower += found.points[i].end_b > found.points[i].end_a ? 1 : 0;
  }
  return fmt::format("Of {} that both have, B is faster at {}, as fast as A at {} and slower at {}.",
                     tables::counted(found.comparable(), "point"), faster,
                     found.comparable() - faster - slower, slower);
}

}  // namespace

std::vector<std::string> verdict_of(const TwoSweeps& found) {
  std::vector<std::string> sentences;
  const std::size_t comparable = found.comparable();
  if (found.points.empty()) {
    sentences.emplace_back("No point is timed in both sweeps, so there is nothing to compare.");
    return sentences;
  }
  if (comparable > 0) {
    sentences.push_back(balance(found));
    const auto end = found.points.begin() + static_cast<std::ptrdiff_t>(comparable);
    const auto by_ratio = [](const JoinedPoint& x, const JoinedPoint& y) { return x.ratio() < y.ratio(); };
    const JoinedPoint& best = *std::min_element(found.points.begin(), end, by_ratio);
    const JoinedPoint& worst = *std::max_element(found.points.begin(), end, by_ratio);
    const auto say = [&](const char* what, const JoinedPoint& point) {
      sentences.push_back(fmt::format("{} at point {} of A ({}): {}.", what, point.a, point.name,
                                      speed_text(point.end_a, point.end_b)));
    };
    if (best.end_b < best.end_a) {
      say("B gains most", best);
    }
    if (worst.end_b > worst.end_a) {
      say("B loses most", worst);
    }
    if (const std::optional<double> mean = mean_ratio(found); mean && best.ratio() != worst.ratio()) {
      sentences.push_back(
          fmt::format("In the geometric mean B takes {} times as long as A.", tables::times(*mean)));
    }
  }
  if (comparable < found.points.size()) {
    sentences.push_back(
        fmt::format("{} different frames: {} times say nothing about the machines.",
                    found.points.size() - comparable == 1
                        ? "1 joined point renders"
                        : tables::counted(found.points.size() - comparable, "joined point") + " render",
                    found.points.size() - comparable == 1 ? "its" : "their"));
  }
  if (found.equal == found.points.size()) {
    sentences.emplace_back("All points are equal in every counter.");
  }
  return sentences;
}

std::string text_of(const TwoSweeps& found, bool all) {
  std::string text = fmt::format("A  {}\nB  {}\n\n", printable(found.a), printable(found.b));
  const auto out = std::back_inserter(text);
  text += verdict_lines(verdict_of(found));
  if (!found.frame.empty()) {
    fmt::format_to(out, "\nframe          {} in which joined points differ\n{}",
                   tables::counted(found.frame.size(), "setting"), settings_lines(found.frame));
  }
  text += "\n";
  if (found.version_a != found.version_b) {
    fmt::format_to(out, "version        A is of {}, B of {}\n", printable(found.version_a),
                   printable(found.version_b));
  }
  fmt::format_to(
      out, "points         {} in both, joined by {}, {} of them timed in both; {} only in A, {} only in B\n",
      found.both, found.by_axes ? "the values of their axes" : "all settings", found.points.size(),
      found.only_a.size(), found.only_b.size());
  text += whose_points("A", found.only_a, all);
  text += whose_points("B", found.only_b, all);
  if (!found.alike.empty()) {
    fmt::format_to(out, "configuration  {} at every joined point alike\n{}",
                   differ(found.alike.size(), "setting"), settings_lines(found.alike));
  }
  if (found.points.empty()) {
    return text;
  }
  fmt::format_to(out, "results        {} equal in every counter, {} not\n", found.equal,
                 found.points.size() - found.equal);
  fmt::format_to(out, "counters       {} differ, {} equal\n", found.differing.size(),
                 found.counters - found.differing.size());
  if (found.differing.empty()) {
    return text;
  }
  text += "\n" + point_lines(found, all);
  if (!found.times.empty()) {
    text += time_lines(found);
  }
  return text + counter_lines(found, all);
}

std::string json_of(const TwoSweeps& found) {
  Json counters = Json::array();
  for (const CounterDifference& counter : found.differing) {
    Json& object = counters.emplace_back(json_of(counter.largest));
    object["point_a"] = counter.a;
    object["point_b"] = counter.b;
    object["machines"] = counter.points;
  }
  Json points = Json::array();
  for (const JoinedPoint& point : found.points) {
    Json axes = Json::object();
    for (std::size_t i = 0; i < found.axes.size(); ++i) {
      axes[found.axes[i]] = tables::json_of(point.values[i]);
    }
    points.push_back({{"point_a", point.a},
                      {"point_b", point.b},
                      {"axes", axes},
                      {"end_a", point.end_a},
                      {"end_b", point.end_b},
                      {"ratio", point.same_frame ? Json(point.ratio()) : Json()},
                      {"settings", settings_json(point.settings)}});
  }
  const Json times = sim::mapped(found.times, [&](const MeanChange& time) {
    return Json{{"name", "time_" + time.activity}, {"change_of_frame", time.of_frame}};
  });
  const std::optional<double> mean = mean_ratio(found);
  return tables::json_text(Json{{"a", {{"name", found.a}, {"version", found.version_a}}},
                                {"b", {{"name", found.b}, {"version", found.version_b}}},
                                {"verdict", verdict_of(found)},
                                {"joined_by", found.by_axes ? "axes" : "settings"},
                                {"machines_in_both", found.both},
                                {"timed_in_both", found.points.size()},
                                {"equal_machines", found.equal},
                                {"points_only_in_a", found.only_a},
                                {"points_only_in_b", found.only_b},
                                {"mean_ratio", mean ? Json(*mean) : Json()},
                                {"times", times},
                                {"frame_settings", settings_json(found.frame)},
                                {"settings", settings_json(found.alike)},
                                {"points", points},
                                {"counters", counters}});
}

}  // namespace marti::studies::compare
