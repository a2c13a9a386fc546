// The parts of a comparison: the same ones whatever is compared.
#include "studies/compare/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>
#include <span>

#include "sim/joined.h"
#include "sim/mapped.h"
#include "studies/report/model/chart_library.h"
#include "studies/sweep/plan/axis_text.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

using report::SortedCell;
using Json = nlohmann::ordered_json;

constexpr std::size_t most_drawn = 20'000;

template <std::integral Number>
SortedCell integer_cell(Number number) {
  return {std::to_string(number), static_cast<double>(number)};
}

SortedCell time_cell(double ps) { return {tables::computed_seconds(ps), ps}; }

SortedCell setting_cell(const std::string& key, const tables::Cell& value) {
  return {setting_text(value), setting_number(key, value)};
}

SortedCell figure_cell(const std::string& figure, const tables::Cell& value) {
  const std::optional<double> number = tables::number_of(value);
  return {tables::figure_text(value, unit_of_figure(figure), "-"),
          number && std::isfinite(*number) ? number : std::nullopt};
}

void drop_column(std::string_view name, report::SortedTable& table) {
  const auto column = std::ranges::find(table.columns, name, &report::SortedColumn::name);
  for (std::vector<SortedCell>& row : table.rows) {
    row.erase(row.begin() + (column - table.columns.begin()));
  }
  table.columns.erase(column);
}

report::SortedTable settings_table(const std::string& title, const std::vector<Difference>& settings) {
  report::SortedTable table{title,
                            {{"key", false, "of the configuration"},
                             {"A", false, "- where the machine does not use it"},
                             {"B", false, "- where the machine does not use it"},
                             {page_column, false, ""}},
                            {}};
  for (const Difference& of : settings) {
    const std::optional<std::size_t> key = sweep::sweep_schema().find(of.name);
    const std::string meaning = key ? sweep::sweep_schema().keys()[*key].meaning : std::string();
    table.rows.push_back({{of.name}, setting_cell(of.name, of.a), setting_cell(of.name, of.b), {meaning}});
  }
  return table;
}

report::SortedTable figures_table(const std::string& title, const std::vector<FigureDifference>& figures,
                                  const Comparison& found) {
  report::SortedTable table{title,
                            {{"figure", false, "name in the catalogue: marti figures"},
                             {"A", true, ""},
                             {"B", true, ""},
                             {"change", true, "from A to B; sorted by |B - A| / max(|A|, |B|)"},
                             {"points", true, "that differ in it"},
                             {"at point", true, "where it differs most"},
                             {page_column, false, ""}},
                            {}};
  for (const FigureDifference& of : figures) {
    table.rows.push_back({{of.name},
                          figure_cell(of.name, of.a),
                          figure_cell(of.name, of.b),
                          {change_of(of), of.relative()},
                          integer_cell(of.points),
                          integer_cell(found.sweep_is_a ? of.point_a : of.point_b),
                          {meaning_of_figure(of.name)}});
  }
  if (found.join == Join::one) {
    drop_column("points", table);
    drop_column("at point", table);
  }
  return table;
}

report::SortedTable times_table(const std::vector<ActivityTime>& times) {
  report::SortedTable table{"Mean time of a node by activity",
                            {{"activity", false, "see docs/internals/model.md, Accounting"},
                             {"A", true, ""},
                             {"B", true, ""},
                             {"change", true, "B less A"},
                             {"of A's frame", true, "the change by the frame time of A"}},
                            {}};
  for (const ActivityTime& time : times) {
    table.rows.push_back({{time.activity},
                          time_cell(time.mean_a),
                          time_cell(time.mean_b),
                          {tables::signed_seconds(std::llround(time.change)), time.change},
                          {tables::signed_percent(time.of_frame), time.of_frame}});
  }
  return table;
}

report::SortedTable points_table(const Comparison& found) {
  report::SortedTable table{
      "Joined points", {{"point of A", true, "its number"}, {"point of B", true, "its number"}}, {}};
  for (const std::string& axis : found.axes) {
    table.columns.push_back({axis, false, "axis"});
  }
  table.columns.insert(table.columns.end(),
                       {{"A", true, "frame time"},
                        {"B", true, "frame time"},
                        {"B / A", true, "of the frame times; none where the frames differ"},
                        {"settings", true, "that both machines use and that differ"}});
  for (const JoinedPoint& point : found.points) {
    std::vector<SortedCell>& row = table.rows.emplace_back();
    row = {integer_cell(point.a), integer_cell(point.b)};
    for (std::size_t axis = 0; axis < found.axes.size(); ++axis) {
      row.push_back(
          {sweep::axis_text(found.axes[axis], point.values[axis]), tables::number_of(point.values[axis])});
    }
    row.push_back(time_cell(static_cast<double>(point.end_a)));
    row.push_back(time_cell(static_cast<double>(point.end_b)));
    row.push_back(point.same_frame ? SortedCell{fmt::format("{:.4f}", point.ratio()), point.ratio()}
                                   : SortedCell{"frames"});
    row.push_back(integer_cell(point.distance));
  }
  if (found.join == Join::each) {
    drop_column(found.sweep_is_a ? "point of B" : "point of A", table);
  }
  if (found.comparable == 0) {
    drop_column("B / A", table);
  }
  return table;
}

report::ReportChart chart_of(std::string_view name, const char* title, const char* note, const Json& rows) {
  report::ReportChart chart =
      report::chart_of_results(tables::chart_named(report::report_chart_specifications(), name), rows);
  chart.title = title;
  chart.note = note;
  return chart;
}

report::ReportChart ratio_chart(const Comparison& found) {
  const std::span points(found.points.data(), std::min(found.comparable, most_drawn));
  return chart_of("compare_points", "Frame time of B by that of A, for each point",
                  "Below the line B is faster.", sim::mapped(points, [&](const JoinedPoint& point) {
                    return Json{{"point", found.point(point)},
                                {"name", point.name},
                                {"a_ps", point.end_a},
                                {"b_ps", point.end_b},
                                {"ratio", point.ratio()},
                                {"which", point.end_b < point.end_a   ? "B is faster"
                                          : point.end_b > point.end_a ? "B is slower"
                                                                      : "equal"}};
                  }));
}

report::ReportChart times_chart(const std::vector<ActivityTime>& times) {
  return chart_of(
      "compare_times", "Where the time went", "The changes add up to that of the frame time.",
      sim::mapped(times, [](const ActivityTime& time) {
        return Json{{"activity", time.activity}, {"a_ps", time.mean_a},
                    {"b_ps", time.mean_b},       {"change_ms", time.change * 1e-9},
                    {"of_frame", time.of_frame}, {"which", time.change > 0.0 ? "more in B" : "less in B"}};
      }));
}

// "1 setting differs", "3 settings differ".
std::string differ(std::size_t number, std::string_view what) {
  return tables::counted(number, what) + (number == 1 ? " differs" : " differ");
}

ComparisonPart machine_part(const Comparison& found) {
  std::vector<Difference> settings = found.alike;
  if (found.comparable == 0) {
    // They stand in the frame's part.
    std::erase_if(settings, [](const Difference& setting) { return is_frame_setting(setting.name); });
  }
  std::string sentence = differ(settings.size(), "setting");
  if (found.join != Join::one) {
    sentence += fmt::format(" at every point alike, {} from point to point", found.varied_settings);
  }
  sentence += fmt::format(", {} equal", found.equal_settings);
  ComparisonPart part{"machine", "What differs in the machine", "configuration", {sentence}};
  if (!settings.empty()) {
    part.tables.push_back(settings_table("Settings", settings));
  }
  part.whole = true;  // what differs in the configuration is never cut off
  return part;
}

ComparisonPart points_part(const Comparison& found) {
  constexpr std::array<const char*, 4> joined_by = {"", "with one result", "by the values of their axes",
                                                    "by all settings"};
  ComparisonPart part{"points",
                      "Points",
                      "points",
                      {fmt::format("{} joined {}, {} of them timed", tables::counted(found.both, "point"),
                                   joined_by[static_cast<std::size_t>(found.join)], found.points.size())}};
  for (const Side* side : {&found.a, &found.b}) {
    constexpr std::size_t most_named = 20;
    std::vector<std::string> names;
    for (const std::int64_t point : side->alone) {
      names.push_back(names.size() == most_named ? "..." : std::to_string(point));
      if (names.size() > most_named) {
        break;
      }
    }
    if (!names.empty()) {
      part.sentences.push_back(fmt::format("{} only in {}: {}", side->alone.size(),
                                           side == &found.a ? "A" : "B", sim::joined(names)));
    }
  }
  if (!found.own_values.empty()) {
    part.sentences.push_back(fmt::format("{}: {}", found.sweep_is_a ? "B" : "A", found.own_values));
  }
  if (found.comparable > 0) {
    part.charts.push_back(ratio_chart(found));
  }
  if (!found.points.empty()) {
    part.tables.push_back(points_table(found));
  }
  return part;
}

ComparisonPart figures_part(const Comparison& found, bool all) {
  const auto none = std::ranges::find_if(found.figures, &Difference::is_one_sided);
  const std::vector<FigureDifference> differing(found.figures.begin(), none);
  const std::vector<FigureDifference> one_sided(none, found.figures.end());
  ComparisonPart part{"counters",
                      "Figures, the largest change first",
                      "results",
                      {fmt::format("{}, {} equal", differ(differing.size(), "figure"), found.equal_figures)}};
  if (found.join != Join::one) {
    part.sentences.push_back(fmt::format("{} equal in every counter, {} not",
                                         tables::counted(found.equal_points, "point"),
                                         found.points.size() - found.equal_points));
  }
  const auto add = [&](const char* title, const std::vector<FigureDifference>& figures) {
    if (!figures.empty()) {
      part.tables.push_back(figures_table(title, figures, found));
    }
  };
  add("Figures that differ", differing);
  add("Figures that only one has", one_sided);
  if (all) {
    add("Equal figures", found.equal);
  }
  return part;
}

}  // namespace

ComparisonPage page_of(const Comparison& found, bool all) {
  const auto who_is = [](const char* letter, const Side& side) {
    return fmt::format("{} is {}, made by marti {}.", letter, side.name, side.version);
  };
  ComparisonPage page{fmt::format("{} compared with {}", found.b.name, found.a.name),
                      found.a.name,
                      found.b.name,
                      who_is("A", found.a) + " " + who_is("B", found.b),
                      {}};
  std::vector<std::string> sentences = verdict_of(found);
  const std::vector<std::string> helps = helps_of(found);
  sentences.insert(sentences.end(), helps.begin(), helps.end());
  page.parts.push_back({"answer", "The verdict", "verdict", sentences});
  if (!found.frame.empty()) {
    page.parts.push_back({"frame",
                          "What differs in the frame",
                          "frame",
                          {tables::counted(found.frame.size(), "setting") + " of frames that differ"}});
    page.parts.back().tables.push_back(settings_table("Settings of the frame", found.frame));
    page.parts.back().whole = true;
  }
  page.parts.push_back(machine_part(found));
  if (found.join != Join::one) {
    page.parts.push_back(points_part(found));
  }
  if (!found.times.empty() && !found.figures.empty()) {
    page.parts.push_back({"time",
                          "Where the time went",
                          "time",
                          {fmt::format("mean of a node{}; the changes add up to that of the frame time",
                                       found.join == Join::one ? "" : " and of all points")}});
    page.parts.back().charts.push_back(times_chart(found.times));
    page.parts.back().tables.push_back(times_table(found.times));
  }
  if (!found.points.empty()) {
    page.parts.push_back(figures_part(found, all));
  }
  return page;
}

}  // namespace marti::studies::compare
