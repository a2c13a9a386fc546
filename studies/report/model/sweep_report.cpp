#include "studies/report/model/sweep_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "studies/keys/setting_value.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/model/explorer.h"
#include "studies/report/model/report_points.h"
#include "studies/report/model/sweep_answer.h"
#include "studies/report/model/verdicts.h"
#include "studies/tables/claim.h"
#include "studies/tables/text_units.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

// A figure that no machine of the sweep has gets no place in the legend.
void keep_folded(Json& spec, const Json& names) {
  Json& first = spec["transform"][0];
  if (!first.contains("fold")) {
    return;
  }
  Json& folded = first["fold"];
  for (std::size_t i = folded.size(); i-- > 0;) {
    if (std::ranges::find(names, folded[i]) != names.end()) {
      continue;
    }
    for (const char* channel : {"color", "shape"}) {
      for (const char* part : {"domain", "range"}) {
        const Json::json_pointer place("/encoding/" + std::string(channel) + "/scale/" + part);
        if (spec.contains(place) && spec[place].size() == folded.size()) {
          spec[place].erase(i);
        }
      }
    }
    folded.erase(i);
  }
}

// Takes the ideal speed-up out of the chart of a figure that has none.
void drop_ideal(Json& spec) {
  std::size_t ideal = 0;
  for (std::size_t i = 0; i < spec["layer"].size(); ++i) {
    Json& encoding = spec["layer"][i]["encoding"];
    if (encoding.contains("color")) {
      ideal = encoding["color"]["datum"] == "ideal" ? i : ideal;
      encoding["color"]["scale"]["domain"].erase(2);
      encoding["color"]["scale"]["range"].erase(2);
    }
  }
  spec["layer"].erase(ideal);
}

bool has_field(const ReportData& report, const std::string& field) {
  return report.explorer["columns"].contains(field);
}

// Fields of the figures that at least one machine has.
Json fields_of(const Json& live, const ReportData& report) {
  Json fields = Json::array();
  for (const Json& field : live.value("fields", Json::array())) {
    if (has_field(report, field)) {
      fields.push_back(field);
    }
  }
  return fields;
}

// A chart that follows the reader (sweep.axes[*along]: at first), or with `axis` runs along this one always.
void add_live(const DescribedChart& described, const ReportPoints& sweep, std::optional<std::size_t> along,
              std::optional<std::size_t> axis, ReportData& report) {
  const Json& meta = described.meta;
  Json live = meta.at("live");
  const std::string rows = live.at("rows");
  const std::string price = sweep.priced ? "price" : "number of nodes";
  std::string title = replaced(meta.at("title"), {{"PRICE", price}});
  if (rows == "all") {
    if (sweep.points.size() < 2 || !has_field(report, live.at("by"))) {
      return;
    }
  } else {
    if (rows == "slice") {
      live["fields"] = fields_of(live, report);
    }
    if (!along || (rows == "slice" && live["fields"].empty())) {
      return;
    }
    live[axis ? "axis" : "title"] = axis ? Json(*axis) : Json(title);
    title += " over " + sweep.axes[axis.value_or(*along)].name;
  }
  ChartWords words;
  const Json given = meta.value("words", Json::object());
  for (const auto& [word, other] : given.items()) {
    words.emplace_back(word, replaced(other, {{"PRICE", price}}));
  }
  const std::string name = meta.value("name", std::string(described.file)) +
                           (axis ? "_" + plain_name(sweep.axes[*axis].name) : "");
  ReportChart chart = live_chart(described.file, name, title, live, words);
  chart.note = meta.at("note");
  if (rows == "slice") {
    keep_folded(chart.spec, live["fields"]);
  }
  if (!meta.value("ideal", true)) {
    drop_ideal(chart.spec);
  }
  // A logarithm has no place for a machine that is free.
  if (rows == "all" && std::ranges::any_of(sweep.points, [&](const ReportPoint& point) {
        const std::string by = live.at("by");
        return point.has(by) && point.figure(by) <= 0.0;
      })) {
    chart.spec["encoding"]["x"]["scale"] = {{"type", "linear"}, {"nice", false}};
  }
  report.charts.push_back(std::move(chart));
}

void add_live_charts(const ReportPoints& sweep, std::optional<std::size_t> along, ReportData& report) {
  for (const DescribedChart& described : described_charts("sweep")) {
    const Json prefixes = described.meta.value("along", Json());
    if (!prefixes.is_array()) {
      add_live(described, sweep, along, std::nullopt, report);
      continue;
    }
    for (std::size_t axis = 0; axis < sweep.axes.size(); ++axis) {
      if (std::ranges::any_of(prefixes, [&](const Json& prefix) {
            return sweep.axes[axis].name.starts_with(prefix.get<std::string>());
          })) {
        add_live(described, sweep, along, axis, report);
      }
    }
  }
}

tables::Table front_table(const ReportPoints& sweep, const Chosen& chosen) {
  tables::Table table(
      "front", "Machines that no other beats in price and frame time",
      {tables::count_column("ordinal", "number of the point in the sweep, from 0"),
       tables::text_column("machine", "its values"),
       tables::real_column("price", "1", sweep.priced ? "cost by [prices]" : "number of nodes"),
       tables::real_column("frame_time", "ms", "from its start until the last node is done"),
       tables::real_column("speed_up", "1", "over the base machine"),
       tables::real_column("efficiency", "fraction", "speed-up by the number of nodes"),
       tables::text_column("advice", "what would help it, measured by replays of changed machines")});
  for (const std::size_t i : chosen.front) {
    const ReportPoint& point = sweep.points[i];
    const auto cell = [&](const char* name) {
      return point.has(name) ? tables::Cell(point.figure(name)) : tables::Cell();
    };
    table.add_row({point.ordinal, place_text(sweep, point), point.figure("price"), point.figure("end") * 1e-9,
                   cell("speed_up"), cell("efficiency"), point.advice});
  }
  return table;
}

// A bar for each axis, the longest first: a tornado chart.
ReportChart effects_chart(const sweep::AxisEffects& effects) {
  tables::Table table("axis_effects", "Which setting matters most",
                      {tables::text_column("axis", "keys that change together"),
                       tables::text_column("fastest", "its value with the shortest frames"),
                       tables::real_column("fastest_by", "1", "their time by that of all points"),
                       tables::text_column("slowest", "its value with the longest frames"),
                       tables::real_column("slowest_by", "1", "their time by that of all points"),
                       tables::real_column("ratio", "1", "slowest by fastest")});
  for (const sweep::AxisEffect& effect : effects.axes) {
    table.add_row(
        {effect.axis, effect.fastest, effect.fastest_by, effect.slowest, effect.slowest_by, effect.ratio()});
  }
  return make_chart(table.name(), table,
                    "Geometric means of the frame time at the best and the worst value of each axis.");
}

// "teapot:12, 512 x 512 pixels; machine.nodes 1 to 256, cache.size 4 KiB to 64 KiB": the frame, and what is
// varied.
std::string about_sweep(const ReportPoints& sweep) {
  const std::map<std::string, std::string> shared(sweep.settings.begin(), sweep.settings.end());
  std::string text;
  if (const auto scene = shared.find("scene.source"); scene != shared.end()) {
    text += keys::plain_setting(scene->second);
  }
  if (const std::string pixels = keys::pixels_of(shared); !pixels.empty()) {
    text += (text.empty() ? "" : ", ") + pixels;
  }
  std::string varied;
  for (const ReportAxis& axis : sweep.axes) {
    varied += (varied.empty() ? "" : ", ") + axis.name;
    varied += axis.numeric ? " " + axis.texts.front() + " to " + axis.texts.back()
                           : fmt::format(" ({} names)", axis.texts.size());
  }
  return text + (text.empty() || varied.empty() ? "" : "; ") + varied;
}

// The axis that the page begins with: nodes, else the first of numbers, else the first.
std::optional<std::size_t> first_axis(const ReportPoints& sweep) {
  if (const std::optional<std::size_t> nodes = sweep.axis("machine.nodes");
      nodes && sweep.axes[*nodes].numeric) {
    return nodes;
  }
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    if (sweep.axes[i].numeric) {
      return i;
    }
  }
  return sweep.axes.empty() ? std::nullopt : std::optional<std::size_t>(0);
}

void add_to(std::vector<std::string>& sentences, const std::vector<std::string>& more) {
  sentences.insert(sentences.end(), more.begin(), more.end());
}

}  // namespace

ReportData sweep_report(const ReportPoints& sweep, std::optional<double> budget) {
  const Chosen chosen = choose(sweep, budget);
  const std::optional<std::size_t> axis = first_axis(sweep);
  ReportData report;
  report.kind = "sweep";
  report.title = "Sweep of " + tables::counted(sweep.points.size(), "machine");
  report.about = about_sweep(sweep);
  if (!sweep.answers.asks.empty()) {
    report.title = sweep.answers.asks;
  }
  report.answer = sweep.answers.answer;
  if (!sweep.answers.claims.empty()) {
    add_to(report.answer, verdict_sentences(tables::claim_table(sweep.answers.claims)));
  }
  add_to(report.answer, answer_of(sweep, chosen));
  report.explorer = explorer_json(sweep, chosen, axis);
  add_live_charts(sweep, axis, report);
  if (!sweep.effects.axes.empty()) {
    report.charts.push_back(effects_chart(sweep.effects));
  }
  for (const tables::Table& table : sweep.answers.tables) {
    report.tables.push_back({table, false});
  }
  if (!sweep.answers.claims.empty()) {
    report.tables.push_back({tables::claim_table(sweep.answers.claims), false});
  }
  constexpr std::size_t few = 12;
  report.tables.push_back({front_table(sweep, chosen), chosen.front.size() > few});
  for (const auto& [key, value] : sweep.settings) {
    report.configuration += key + " = " + value + "\n";
  }
  report.provenance = sweep.provenance;
  return report;
}

}  // namespace marti::studies::report
