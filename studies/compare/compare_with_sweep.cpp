#include "studies/compare/compare_with_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "studies/compare/compare_text.h"
#include "studies/compare/differences.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

struct Point {
  std::int64_t ordinal = 0;
  std::int64_t end = 0;
  double ratio = 0.0;                // frame time of B / frame time of A
  std::vector<Difference> settings;  // in which it differs from the result, without SweepComparison::alike
};

struct SweepComparison {
  std::string a;  // names
  std::string b;
  bool sweep_is_a = false;
  std::int64_t end = 0;           // of the result
  std::size_t planned = 0;        // points of the sweep
  std::vector<Point> points;      // the timed ones, the shortest frame first, then by number
  std::vector<Difference> alike;  // settings in which all points differ from the result by the same value
  std::vector<Difference>
      varied;  // the other settings in which a point differs, if possible of a point that has them
  std::size_t equal_settings = 0;

  [[nodiscard]] const char* result_letter() const { return sweep_is_a ? "B" : "A"; }
  [[nodiscard]] Cell Difference::*of_result() const { return sweep_is_a ? &Difference::b : &Difference::a; }
  [[nodiscard]] Cell Difference::*of_sweep() const { return sweep_is_a ? &Difference::a : &Difference::b; }
};

std::int64_t frame_time(const Cell& end, const std::string& whose) {
  const auto* ticks = std::get_if<std::int64_t>(&end);
  if (ticks == nullptr || *ticks <= 0) {
    throw sim::UserError(whose + ": has no frame time (a figure \"end\" above 0)");
  }
  return *ticks;
}

// Moves the differences that all points share out of their lists.
void move_alike(SweepComparison& found) {
  std::map<std::string, std::vector<const Difference*>> by_name;
  for (const Point& point : found.points) {
    for (const Difference& difference : point.settings) {
      by_name[difference.name].push_back(&difference);
    }
  }
  for (const auto& [name, differences] : by_name) {
    const Difference& first = *differences.front();
    const bool alike = differences.size() == found.points.size() &&
                       std::all_of(differences.begin(), differences.end(), [&first](const Difference* other) {
                         return other->a == first.a && other->b == first.b;
                       });
    const auto both = std::find_if(differences.begin(), differences.end(), [](const Difference* difference) {
      return difference->a != Cell() && difference->b != Cell();
    });
    (alike ? found.alike : found.varied).push_back(both == differences.end() ? first : **both);
  }
  for (Point& point : found.points) {
    std::erase_if(point.settings, [&found](const Difference& difference) {
      return std::any_of(found.alike.begin(), found.alike.end(),
                         [&](const Difference& alike) { return alike.name == difference.name; });
    });
  }
}

SweepComparison comparison_of(const ComparedResult& result, const SweepReader& sweep, bool sweep_is_a) {
  SweepComparison found;
  const std::string file = sweep.file().string();
  found.a = sweep_is_a ? file : result.name;
  found.b = sweep_is_a ? result.name : file;
  found.sweep_is_a = sweep_is_a;
  const auto end = result.figures.find("end");
  found.end = frame_time(end == result.figures.end() ? Cell() : end->second, result.name);
  ComparedResult own{{}, result.version, result.settings, {}};
  keep_what_sweeps_have(own);
  const std::vector<std::string> names = {"end"};
  sweep.for_each_point(names, [&](const StoredPoint& stored, std::span<const Cell> figures) {
    ++found.planned;
    if (!stored.done) {
      return;
    }
    ComparedResult other{{}, sweep.version(), {}, {}};
    for (auto& [key, value] : sweep.settings(stored.machine)) {
      other.settings.emplace(key, std::move(value));
    }
    keep_what_sweeps_have(other);
    Point& point = found.points.emplace_back();
    point.ordinal = stored.ordinal;
    point.end = frame_time(figures[0], file + ":" + std::to_string(stored.ordinal));
    point.ratio = static_cast<double>(sweep_is_a ? found.end : point.end) /
                  static_cast<double>(sweep_is_a ? point.end : found.end);
    point.settings = (sweep_is_a ? differences_of(other, own) : differences_of(own, other)).settings;
  });
  if (found.points.empty()) {
    throw sim::UserError(file +
                         ": no point of this sweep has been run yet; run the sweep again to finish it");
  }
  std::stable_sort(found.points.begin(), found.points.end(),
                   [](const Point& x, const Point& y) { return x.end < y.end; });
  move_alike(found);
  const auto differ = [&own](const std::vector<Difference>& differences) {
    return static_cast<std::size_t>(std::count_if(
        differences.begin(), differences.end(),
        [&own](const Difference& difference) { return own.settings.contains(difference.name); }));
  };
  found.equal_settings = own.settings.size() - differ(found.alike) - differ(found.varied);
  return found;
}

// "cache.size "4 KiB", machine.nodes 8": the values of one side. A setting that only one side has is listed
// if `all`; it follows from another one, as the ways of a cache from its being there.
std::string values_of(const std::vector<Difference>& settings, Cell Difference::*side, bool all) {
  std::string text;
  for (const Difference& setting : settings) {
    if (all || (setting.a != Cell() && setting.b != Cell())) {
      text += (text.empty() ? "" : ", ") + setting.name + " " + short_text(setting.*side, "-");
    }
  }
  return printable(text.empty() ? "-" : text);
}

std::string text_of(const SweepComparison& found, bool all) {
  const std::vector<Point>& points = found.points;
  // The points are sorted.
  const auto [first, last] = std::equal_range(points.begin(), points.end(), Point{0, found.end, 0.0, {}},
                                              [](const Point& x, const Point& y) { return x.end < y.end; });
  std::string text = fmt::format("A  {}\nB  {}\n\n", printable(found.a), printable(found.b));
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "configuration  {} differ{} in every point alike, {} from point to point, {} equal\n",
                 count(found.alike.size(), "setting"), found.alike.size() == 1 ? "s" : "",
                 found.varied.size(), found.equal_settings);
  text += lines_of(found.alike, true);
  fmt::format_to(out, "\npoints         {}, {} of them timed: {} faster than {}, {} as fast, {} slower\n",
                 found.planned, points.size(), first - points.begin(), found.result_letter(), last - first,
                 points.end() - last);
  const Point& best = points.front();
  fmt::format_to(out, "best           point {}: {}, B / A = {:.4f}\n\n", best.ordinal, seconds(best.end),
                 best.ratio);
  const auto line = [&](const auto& point, const std::string& time, const std::string& ratio,
                        const std::string& settings) {
    fmt::format_to(out, "  {:>7}  {:>11}  {:>9}  {}\n", point, time, ratio, settings);
  };
  line("point", "frame time", "B / A", "settings that differ from point to point");
  line(found.result_letter(), seconds(found.end), "", values_of(found.varied, found.of_result(), all));
  const std::size_t shown = all ? points.size() : std::min(points.size(), most_lines);
  for (std::size_t i = 0; i < shown; ++i) {
    line(points[i].ordinal, seconds(points[i].end), fmt::format("{:.4f}", points[i].ratio),
         values_of(points[i].settings, found.of_sweep(), all));
  }
  if (shown < points.size()) {
    fmt::format_to(out, "  and {} more: --all lists them\n", points.size() - shown);
  }
  return text;
}

std::string json_of(const SweepComparison& found) {
  Json points = Json::array();
  for (const Point& point : found.points) {
    points.push_back({{"point", point.ordinal},
                      {"end", point.end},
                      {"ratio", point.ratio},
                      {"settings", studies::json_of(point.settings)}});
  }
  return json_text(Json{{"a", {{"name", found.a}}},
                        {"b", {{"name", found.b}}},
                        {"sweep", found.sweep_is_a ? "a" : "b"},
                        {"end", found.end},
                        {"planned_points", found.planned},
                        {"settings", studies::json_of(found.alike)},
                        {"equal_settings", found.equal_settings},
                        {"points", points}});
}

}  // namespace

std::string compare_with_sweep(const ComparedResult& result, const std::filesystem::path& sweep,
                               SweepSide side, const CompareOptions& options) {
  const SweepComparison found = comparison_of(result, SweepReader(sweep), side == SweepSide::a);
  return options.json ? json_of(found) : text_of(found, options.all);
}

}  // namespace marti::studies
