// The page of each kind of comparison.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/compare/compare_text.h"
#include "studies/compare/differences.h"
#include "studies/compare/page_parts.h"
#include "studies/report/model/chart_library.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

// What is compared, as on the command line, and the program that made it.
struct Side {
  const std::string& name;
  std::string version{};
};

// A page that begins with these sentences and with who A and B are.
ComparisonPage begin_page(std::vector<std::string> sentences, const Side& a, const Side& b) {
  sentences.push_back(who_is("A", a.name, a.version));
  sentences.push_back(who_is("B", b.name, b.version));
  return {fmt::format("{} compared with {}", printable(b.name), printable(a.name)),
          {{"answer", "The verdict", std::move(sentences), {}, {}}}};
}

void add_frame_part(const std::vector<Difference>& settings, ComparisonPage& page) {
  if (!settings.empty()) {
    page.parts.push_back(
        {"frame", "What differs in the frame", {}, {}, {settings_table("Settings of the frame", settings)}});
  }
}

void add_machine_part(const std::vector<Difference>& settings, const std::string& equal,
                      ComparisonPage& page) {
  ComparisonPart part{"machine", "What differs in the machine", {equal}, {}, {}};
  if (!settings.empty()) {
    part.tables.push_back(settings_table("Settings", settings));
  }
  page.parts.push_back(std::move(part));
}

report::ReportChart times_chart(const std::vector<ActivityTime>& times, double end) {
  tables::Table table("compare_times", "Where the time went",
                      {tables::text_column("activity", "see docs/internals/model.md, Accounting"),
                       tables::integer_column("a_ps", "ps", "mean of a node of A"),
                       tables::integer_column("b_ps", "ps", "mean of a node of B"),
                       tables::real_column("change_ms", "ms", "B less A"),
                       tables::real_column("of_frame", "fraction", "the change by the frame time of A"),
                       tables::text_column("which", "whether B spends more")});
  for (const ActivityTime& time : times) {
    table.add_row({time.activity, time.mean_a, time.mean_b, time.change * 1e-9, time.change / end,
                   time.change > 0.0 ? "more in B" : "less in B"});
  }
  return report::make_chart(table.name(), table, "The changes add up to that of the frame time.");
}

report::SortedTable times_table(const std::vector<ActivityTime>& times, double end) {
  report::SortedTable table;
  table.title = "Mean time of a node by activity";
  table.columns = {{"activity", false, "see docs/internals/model.md, Accounting"},
                   {"A", true, ""},
                   {"B", true, ""},
                   {"change", true, "B less A"},
                   {"of A's frame", true, "the change by the frame time of A"}};
  for (const ActivityTime& time : times) {
    table.rows.push_back({{time.activity, {}},
                          time_cell(time.mean_a),
                          time_cell(time.mean_b),
                          {tables::signed_seconds(std::llround(time.change)), time.change},
                          {tables::signed_percent(time.change / end), time.change / end}});
  }
  return table;
}

}  // namespace

ComparisonPage page_of(const ComparedPair& pair) {
  ComparisonPage page =
      begin_page(verdict_of(pair), {pair.a.name, pair.a.version}, {pair.b.name, pair.b.version});
  std::vector<Difference> machine = pair.differences.settings;
  if (!pair.same_frame) {
    add_frame_part(frame_settings(machine), page);
    std::erase_if(machine, [](const Difference& setting) { return is_frame_setting(setting.name); });
  }
  add_machine_part(
      machine,
      fmt::format("{}, {} are equal.", differ(machine.size(), "setting"), pair.differences.equal_settings),
      page);
  ComparisonPart time{"time", "Where the time went", helps_of(pair), {}, {}};
  if (!pair.times.empty()) {
    const auto end = static_cast<double>(frame_time(pair.a));
    time.charts.push_back(times_chart(pair.times, end));
    time.tables.push_back(times_table(pair.times, end));
  }
  if (!time.sentences.empty() || !time.charts.empty()) {
    page.parts.push_back(std::move(time));
  }
  const Differences& found = pair.differences;
  std::vector<Difference> figures = found.texts;
  figures.insert(figures.end(), found.numbers.begin(), found.numbers.end());
  ComparisonPart counters{"counters", "Figures, the largest change first", {}, {}, {}};
  counters.sentences.push_back(
      fmt::format("{}, {} are equal.", differ(figures.size(), "figure"), found.equal.size()));
  if (!figures.empty()) {
    counters.tables.push_back(figures_table("Figures that differ", figures));
  }
  if (!found.one_side.empty()) {
    counters.tables.push_back(figures_table("Figures that only one has", found.one_side));
  }
  page.parts.push_back(std::move(counters));
  return page;
}

ComparisonPage page_of(const ResultAndSweep& found) {
  ComparisonPage page = begin_page(verdict_of(found), {found.a}, {found.b});
  add_frame_part(found.frame, page);
  add_machine_part(
      found.alike,
      fmt::format("{} in every point alike, {} from point to point, {} are equal.",
                  differ(found.alike.size(), "setting"), found.varied.size(), found.equal_settings),
      page);
  report::SortedTable table;
  table.title = found.same_frame ? "Points, the shortest frame first" : "Points, the nearest machine first";
  table.columns = {{"point", true, "its number in the sweep"},
                   {"settings", false, "that differ from point to point"},
                   {"frame time", true, ""},
                   {"B / A", true, "of the frame times; empty where the frames differ"},
                   {"differing settings", true, "that both machines use"}};
  std::vector<RatioPoint> ratios;
  for (std::size_t i = 0; i < std::min(found.points.size(), most_page_points); ++i) {
    const ComparedPoint& point = found.points[i];
    const std::string name =
        (point.name.empty() ? "" : point.name + ": ") + values_text(point.settings, found.of_sweep(), false);
    table.rows.push_back({integer_cell(point.ordinal),
                          {name, {}},
                          time_cell(point.end),
                          found.same_frame ? ratio_cell(point.ratio) : report::SortedCell(),
                          integer_cell(static_cast<std::int64_t>(point.distance))});
    ratios.push_back({point.ordinal, name, found.sweep_is_a() ? point.end : found.end,
                      found.sweep_is_a() ? found.end : point.end});
  }
  ComparisonPart points{"points", "Points", {}, {}, {}};
  const std::string values =
      found.varied.empty() ? "" : ": " + values_text(found.varied, found.of_result(), false);
  points.sentences.push_back(
      fmt::format("{} takes {}{}.", found.result_letter(), tables::seconds(found.end), values));
  if (found.same_frame) {
    points.charts.push_back(ratio_chart(ratios));
  }
  points.tables.push_back(std::move(table));
  page.parts.push_back(std::move(points));
  return page;
}

ComparisonPage page_of(const TwoSweeps& found) {
  std::vector<std::string> verdict = verdict_of(found);
  verdict.push_back(fmt::format(
      "{} in both, joined by {}; {} only in A, {} only in B.", tables::counted(found.both, "point"),
      found.by_axes ? "the values of their axes" : "all settings", found.only_a.size(), found.only_b.size()));
  ComparisonPage page =
      begin_page(std::move(verdict), {found.a, found.version_a}, {found.b, found.version_b});
  add_frame_part(found.frame, page);
  add_machine_part(found.alike, differ(found.alike.size(), "setting") + " at every joined point alike.",
                   page);
  if (found.points.empty()) {
    return page;
  }
  report::SortedTable table;
  table.title = "Points, the largest effect first";
  table.columns = {{"point of A", true, "its number"}, {"point of B", true, "its number"}};
  for (const std::string& axis : found.axes) {
    table.columns.push_back({printable(axis), false, "axis of A"});
  }
  table.columns.insert(table.columns.end(), {{"A", true, "frame time"},
                                             {"B", true, "frame time"},
                                             {"B / A", true, "empty where the frames differ"}});
  std::vector<RatioPoint> ratios;
  for (std::size_t i = 0; i < std::min(found.points.size(), most_page_points); ++i) {
    const JoinedPoint& point = found.points[i];
    std::vector<report::SortedCell> row = {integer_cell(point.a), integer_cell(point.b)};
    for (std::size_t axis = 0; axis < found.axes.size(); ++axis) {
      row.push_back({point.texts[axis], tables::number_of(point.values[axis])});
    }
    row.insert(row.end(), {time_cell(point.end_a), time_cell(point.end_b),
                           point.same_frame ? ratio_cell(point.ratio()) : report::SortedCell()});
    table.rows.push_back(std::move(row));
    if (point.same_frame) {
      ratios.push_back({point.a, point.name, point.end_a, point.end_b});
    }
  }
  ComparisonPart points{"points", "Points", {}, {}, {}};
  if (!ratios.empty()) {
    points.charts.push_back(ratio_chart(ratios));
  }
  points.tables.push_back(std::move(table));
  page.parts.push_back(std::move(points));
  if (!found.times.empty()) {
    report::SortedTable times;
    times.title = "Mean change of a node's time by activity";
    times.columns = {{"activity", false, "see docs/internals/model.md, Accounting"},
                     {"of A's frame", true, "B less A by the frame time of A, mean of the points"}};
    for (const MeanChange& time : found.times) {
      times.rows.push_back({{time.activity, {}}, {tables::signed_percent(time.of_frame), time.of_frame}});
    }
    page.parts.push_back({"time", "Where the time went", {}, {}, {std::move(times)}});
  }
  report::SortedTable counters;
  counters.title = "Counters that differ, each where it differs most";
  counters.columns = {{"counter", false, "name in the catalogue: marti figures"},
                      {"points", true, "that differ in it"},
                      {"A", true, ""},
                      {"B", true, ""},
                      {"change", true, "from A to B; sorted by |B - A| / max(|A|, |B|)"},
                      {"at point", true, "of A"},
                      {"meaning", false, ""}};
  for (const CounterDifference& counter : found.differing) {
    const std::string& name = counter.largest.name;
    counters.rows.push_back({{name, {}},
                             integer_cell(static_cast<std::int64_t>(counter.points)),
                             figure_cell(counter.largest.a, name),
                             figure_cell(counter.largest.b, name),
                             change_cell(counter.largest),
                             integer_cell(counter.a),
                             {meaning_of_figure(name), {}}});
  }
  ComparisonPart part{"counters", "Counters, the largest change first", {}, {}, {}};
  part.sentences.push_back(fmt::format("{}, {} are equal.", differ(found.differing.size(), "counter"),
                                       found.counters - found.differing.size()));
  if (!counters.rows.empty()) {
    part.tables.push_back(std::move(counters));
  }
  page.parts.push_back(std::move(part));
  return page;
}

}  // namespace marti::studies::compare
