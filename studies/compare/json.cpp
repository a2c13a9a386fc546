// A comparison as JSON.
#include <array>
#include <nlohmann/json.hpp>

#include "sim/mapped.h"
#include "studies/compare/page.h"
#include "studies/keys/setting_value.h"
#include "studies/tables/json_table.h"

namespace marti::studies::compare {

namespace {

using Json = nlohmann::ordered_json;

Json settings_json(const std::vector<Difference>& settings) {
  // The value as its key has it; null where the machine does not use the setting.
  const auto typed = [](const std::string& key, const tables::Cell& value) {
    const auto* text = std::get_if<std::string>(&value);
    return text == nullptr ? Json() : keys::setting_value(key, *text);
  };
  return sim::mapped(settings, [&](const Difference& setting) {
    return Json{
        {"name", setting.name}, {"a", typed(setting.name, setting.a)}, {"b", typed(setting.name, setting.b)}};
  });
}

Json figure_json(const FigureDifference& figure) {
  Json object = {{"name", figure.name}, {"a", tables::json_of(figure.a)}, {"b", tables::json_of(figure.b)}};
  if (const std::string unit = unit_of_figure(figure.name); !unit.empty()) {
    object["unit"] = unit;
  }
  if (const std::optional<double> relative = figure.relative()) {
    object["relative"] = *relative;
  }
  return object;
}

Json point_json(const Comparison& found, const JoinedPoint& point) {
  Json axes = Json::object();
  for (std::size_t i = 0; i < found.axes.size(); ++i) {
    axes[found.axes[i]] = tables::json_of(point.values[i]);
  }
  Json object = {{"point_a", point.a}, {"point_b", point.b}, {"end_a", point.end_a}, {"end_b", point.end_b}};
  if (found.join == Join::each) {
    object.update(Json{{"point", found.point(point)}, {"end", found.end(point)}});
  }
  object["axes"] = std::move(axes);
  object["ratio"] = point.same_frame ? Json(point.ratio()) : Json();
  object["settings"] = settings_json(point.settings);
  return object;
}

void add_figures_of_two(const Comparison& found, bool all, Json& object) {
  for (const char* list : {"texts", "numbers", "one_side"}) {
    object[list] = Json::array();
  }
  for (const FigureDifference& figure : found.figures) {
    object[figure.is_one_sided() ? "one_side"
           : figure.relative()   ? "numbers"
                                 : "texts"]
        .push_back(figure_json(figure));
  }
  object["equal_figures"] = found.equal_figures;
  if (all) {
    object["equal"] = sim::mapped(found.equal, figure_json);
  }
}

void add_points(const Comparison& found, Json& object) {
  constexpr std::array<const char*, 4> joined_by = {"", "each", "axes", "settings"};
  const std::optional<double> mean = mean_ratio(found);
  object.update(Json{{"joined_by", joined_by[static_cast<std::size_t>(found.join)]},
                     {"machines_in_both", found.both},
                     {"timed_in_both", found.points.size()},
                     {"equal_machines", found.equal_points},
                     {"points_only_in_a", found.a.alone},
                     {"points_only_in_b", found.b.alone},
                     {"points_within_noise", found.points_within_noise()},
                     {"points_of_other_frames", found.points.size() - found.comparable},
                     {"mean_ratio", mean ? Json(*mean) : Json()}});
  if (found.join == Join::each) {
    const Side& sweep = found.sweep_is_a ? found.a : found.b;
    const JoinedPoint& nearest = found.points[found.nearest];
    object.update(Json{{"sweep", found.sweep_is_a ? "a" : "b"},
                       {"end", found.sweep_is_a ? nearest.end_b : nearest.end_a},
                       {"planned_points", sweep.planned},
                       {"timed_points", sweep.timed},
                       {"nearest_point", found.point(nearest)}});
  }
  object["points"] =
      sim::mapped(found.points, [&](const JoinedPoint& point) { return point_json(found, point); });
  object["counters"] = sim::mapped(found.figures, [](const FigureDifference& figure) {
    Json counter = figure_json(figure);
    counter.update(
        Json{{"point_a", figure.point_a}, {"point_b", figure.point_b}, {"machines", figure.points}});
    return counter;
  });
}

}  // namespace

std::string json_of(const Comparison& found, bool all) {
  const auto side = [](const Side& of) { return Json{{"name", of.name}, {"version", of.version}}; };
  Json object = {{"a", side(found.a)},
                 {"b", side(found.b)},
                 {"verdict", verdict_of(found)},
                 {"what_helps", helps_of(found)},
                 {"noise", found.noise.band},
                 {"same_frame", found.comparable > 0},
                 {"frame_settings", settings_json(found.frame)},
                 {"settings", settings_json(found.alike)},
                 {"equal_settings", found.equal_settings},
                 {"times", sim::mapped(found.times, [](const ActivityTime& time) {
                    return Json{{"name", "time_" + time.activity},
                                {"a", tables::json_of(tables::Cell(time.a))},
                                {"b", tables::json_of(tables::Cell(time.b))},
                                {"change_a_node", time.change},
                                {"change_of_frame", time.of_frame}};
                  })}};
  if (found.join == Join::one) {
    add_figures_of_two(found, all, object);
  } else {
    add_points(found, object);
  }
  return tables::json_text(object);
}

}  // namespace marti::studies::compare
