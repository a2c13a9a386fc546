#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sim/mapped.h"
#include "studies/compare/compare_text.h"
#include "studies/compare/result_and_sweep.h"
#include "studies/compare/verdict.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

using Json = nlohmann::ordered_json;

struct PointCounts {
  std::ptrdiff_t faster = 0;
  std::ptrdiff_t equal = 0;
  std::ptrdiff_t slower = 0;
};

PointCounts counts_of(const ResultAndSweep& found) {
  PointCounts counts;
  for (const ComparedPoint& point : found.points) {
    ++(point.end < found.end ? counts.faster : point.end > found.end ? counts.slower : counts.equal);
  }
  return counts;
}

Json point_json(const ResultAndSweep& found, const ComparedPoint& point) {
  Json json = {{"point", point.ordinal}};
  if (!point.name.empty()) {
    json["name"] = point.name;
  }
  json["end"] = point.end;
  json["ratio"] = found.same_frame ? Json(point.ratio) : Json();
  json["settings"] = settings_json(point.settings);
  return json;
}

std::string table_of(const ResultAndSweep& found, bool all) {
  std::string text;
  const auto out = std::back_inserter(text);
  const auto line = [&](const std::string& point, const std::string& time, const std::string& ratio,
                        const std::string& settings) {
    fmt::format_to(out, "  {:>7}  {:>11}  ", point, time);
    if (found.same_frame) {
      fmt::format_to(out, "{:>9}  ", ratio);
    }
    fmt::format_to(out, "{}\n", settings);
  };
  line("point", "frame time", "B / A", "settings that differ from point to point");
  line(found.result_letter(), tables::seconds(found.end), "",
       values_text(found.varied, found.of_result(), all));
  const std::size_t shown = all ? found.points.size() : std::min(found.points.size(), most_lines);
  for (std::size_t i = 0; i < shown; ++i) {
    const ComparedPoint& point = found.points[i];
    line(std::to_string(point.ordinal), tables::seconds(point.end), fmt::format("{:.4f}", point.ratio),
         (point.name.empty() ? "" : printable(point.name) + ": ") +
             values_text(point.settings, found.of_sweep(), all));
  }
  return text + and_more(shown, found.points.size());
}

}  // namespace

std::string point_text(const ResultAndSweep& found, const ComparedPoint& point) {
  const std::string values = values_text(point.settings, found.of_sweep(), false);
  const std::string name = printable(point.name);
  const std::string what = values == "-" ? name : name.empty() ? values : name + ": " + values;
  return fmt::format("point {}{}", point.ordinal, what.empty() ? "" : " (" + what + ")");
}

std::vector<std::string> verdict_of(const ResultAndSweep& found) {
  std::vector<std::string> sentences;
  if (!found.same_frame) {
    sentences.push_back(fmt::format(
        "{} renders another frame than every point of {}: the times are of different work and say "
        "nothing about the machines.",
        found.result_letter(), found.sweep_letter()));
  } else {
    const PointCounts counts = counts_of(found);
    sentences.push_back(fmt::format("Of {}, {} {} faster than {}, {} as fast and {} slower.",
                                    tables::counted(found.points.size(), "point"), counts.faster,
                                    counts.faster == 1 ? "is" : "are", found.result_letter(), counts.equal,
                                    counts.slower));
    const ComparedPoint& best = found.points.front();
    const std::int64_t a = found.sweep_is_a() ? best.end : found.end;
    const std::int64_t b = found.sweep_is_a() ? found.end : best.end;
    sentences.push_back(fmt::format("The fastest is {}. With it as {}, {}.", point_text(found, best),
                                    found.sweep_letter(), speed_text(a, b)));
    if (found.other_frames > 0) {
      sentences.push_back(fmt::format("{} of other frames {} left out.",
                                      tables::counted(found.other_frames, "point"),
                                      found.other_frames == 1 ? "is" : "are"));
    }
  }
  const ComparedPoint& nearest = found.nearest();
  sentences.push_back(fmt::format("The nearest is {}: it differs from {} in {}.", point_text(found, nearest),
                                  found.result_letter(), tables::counted(nearest.distance, "setting")));
  return sentences;
}

std::string text_of(const ResultAndSweep& found, bool all) {
  std::string text = fmt::format("A  {}\nB  {}\n\n", printable(found.a), printable(found.b));
  const auto out = std::back_inserter(text);
  if (!found.same_frame) {
    fmt::format_to(out, "frame          {}\n{}\n", verdict_of(found).front(), settings_lines(found.frame));
  } else if (found.other_frames > 0) {
    fmt::format_to(out, "frame          {} of {} timed points render another frame and are left out\n{}\n",
                   found.other_frames, found.timed, settings_lines(found.frame));
  }
  fmt::format_to(out, "configuration  {} in every point alike, {} from point to point, {} equal\n",
                 differ(found.alike.size(), "setting"), found.varied.size(), found.equal_settings);
  text += settings_lines(found.alike);
  const ComparedPoint& nearest = found.nearest();
  if (found.same_frame) {
    const PointCounts counts = counts_of(found);
    fmt::format_to(out, "\npoints         {}, {} of them timed: {} faster than {}, {} as fast, {} slower\n",
                   found.planned, found.timed, counts.faster, found.result_letter(), counts.equal,
                   counts.slower);
    const ComparedPoint& best = found.points.front();
    fmt::format_to(out, "best           {}: {}, B / A = {:.4f}\n", point_text(found, best),
                   tables::seconds(best.end), best.ratio);
    fmt::format_to(out, "nearest        {}: {}, B / A = {:.4f}, differs in {}\n\n",
                   point_text(found, nearest), tables::seconds(nearest.end), nearest.ratio,
                   tables::counted(nearest.distance, "setting"));
  } else {
    fmt::format_to(out, "\npoints         {}, {} of them timed, all of other frames\n", found.planned,
                   found.timed);
    fmt::format_to(out, "nearest        {}: {}, differs in {}\n\n", point_text(found, nearest),
                   tables::seconds(nearest.end), tables::counted(nearest.distance, "setting"));
  }
  return text + table_of(found, all);
}

std::string json_of(const ResultAndSweep& found) {
  const Json points =
      sim::mapped(found.points, [&](const ComparedPoint& point) { return point_json(found, point); });
  return tables::json_text(Json{{"a", {{"name", found.a}}},
                                {"b", {{"name", found.b}}},
                                {"sweep", found.sweep_is_a() ? "a" : "b"},
                                {"verdict", verdict_of(found)},
                                {"same_frame", found.same_frame},
                                {"end", found.end},
                                {"planned_points", found.planned},
                                {"timed_points", found.timed},
                                {"points_of_other_frames", found.other_frames},
                                {"nearest_point", found.nearest().ordinal},
                                {"frame_settings", settings_json(found.frame)},
                                {"settings", settings_json(found.alike)},
                                {"equal_settings", found.equal_settings},
                                {"points", points}});
}

}  // namespace marti::studies::compare
