#include "studies/report/model/sweep_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "sim/mapped.h"
#include "studies/keys/setting_value.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/model/cycle_groups.h"
#include "studies/report/model/explorer.h"
#include "studies/report/model/report_points.h"
#include "studies/report/model/sweep_answer.h"
#include "studies/tables/text_units.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

// Figures over an axis.
struct SliceChart {
  std::string_view name;  // of chart and specification
  std::string_view title;
  std::string_view note;
  std::vector<std::string> fields;
  std::string what{};  // of the waits: whose
};

constexpr std::string_view percentiles_note =
    "Means are exact; a percentile is the upper end of its bucket of the histogram, at most an eighth too "
    "long.";

std::vector<std::string> waits_of(const std::string& what) {
  return {"mean_" + what + "_wait", what + "_wait_p50", what + "_wait_p95", what + "_wait_p99"};
}

std::vector<SliceChart> charts_over_axis() {
  const std::vector<std::string> parts = sim::mapped(
      cycle_group_names, [&](const std::string_view group) { return "part_" + std::string(group); });
  return {{"efficiency",
           "Efficiency",
           "Speed-up, divided by how many times the base's nodes a machine has; 100 % is the dashed line.",
           {"efficiency"}},
          {"cycles", "Where the cycles go",
           "All nodes' time from 0 to the end of the frame; it adds up to 100 %.", parts},
          {"utilisation",
           "How busy the shared parts are",
           "What comes near 100 % limits the machine.",
           {"interconnect_utilisation", "bank_utilisation", "network_utilisation"}},
          {"waits", "How long nodes wait for the interconnect", percentiles_note, waits_of("interconnect"),
           "interconnect"},
          {"waits", "How long nodes wait for banks", percentiles_note, waits_of("bank"), "bank"}};
}

// Axes along which hit ratios are worth a chart of their own.
bool bears_on_caches(const std::string& name) {
  for (const std::string_view prefix : {"cache.", "l2.", "structure.", "packets.", "layout."}) {
    if (name.starts_with(prefix)) {
      return true;
    }
  }
  return false;
}

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

// Exact points over an axis, joined by lines if it is one of numbers.
void add_explored(const std::string& name, const std::string& title, const ReportAxis& axis, ChartWords words,
                  ReportData& report) {
  ReportChart chart = live_chart("over_axis", name, fmt::format("{} over {}", title, axis.name),
                                 {{"rows", "explorer"}, {"title", title}}, words);
  chart.note =
      "Points and bars are machines of the sweep, simulated exactly; lines only join them. The bound follows "
      "from each point's own counters.";
  report.charts.push_back(std::move(chart));
}

// Over an axis, or without one over that which the reader chooses, at first `first`. Without any of its
// fields there is no chart.
void add_slice(const ReportPoints& sweep, const SliceChart& slice, std::optional<std::size_t> axis,
               std::size_t first, const std::string& name, ReportData& report) {
  const std::string& along = sweep.axes[axis.value_or(first)].name;
  Json fields = Json::array();
  for (const std::string& field : slice.fields) {
    if (report.explorer["columns"].contains(field)) {
      fields.push_back(field);
    }
  }
  if (fields.empty()) {
    return;
  }
  Json live = {{"rows", "slice"}, {"fields", fields}};
  if (axis) {
    live["axis"] = *axis;
  } else {
    live["title"] = slice.title;
  }
  ReportChart chart = live_chart(slice.name, name, fmt::format("{} over {}", slice.title, along), live,
                                 {{"WHAT", slice.what}});
  chart.note = slice.note;
  keep_folded(chart.spec, fields);
  report.charts.push_back(std::move(chart));
}

// Every machine by a figure and its frame time.
void add_front(const ReportPoints& sweep, const std::string& figure, const std::string& title,
               std::string_view axis, ReportData& report) {
  ReportChart chart = live_chart("front", figure, "Frame time and " + title,
                                 {{"rows", "all"}, {"by", figure}}, {{"FIGURE", figure}, {"TITLE", axis}});
  chart.note =
      "Every machine of the sweep; the line joins those that no other beats in both. Named are the "
      "fastest, the knee, the best within the budget where one is given, and the chosen one.";
  const bool has_free = std::ranges::any_of(sweep.points, [&figure](const ReportPoint& point) {
    return point.has(figure) && point.figure(figure) <= 0.0;
  });
  if (has_free) {
    chart.spec["encoding"]["x"]["scale"] = {{"type", "linear"}, {"nice", false}};
  }
  report.charts.push_back(std::move(chart));
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

// "teapot:12, 512 x 512 pixels; machine.nodes 1 to 256, cache.size 4 KiB to 64 KiB": the frame, and what is
// varied.
std::string about_sweep(const ReportPoints& sweep) {
  const std::map<std::string, std::string> shared(sweep.settings.begin(), sweep.settings.end());
  std::string text;
  if (const auto scene = shared.find("scene.source"); scene != shared.end()) {
    text += keys::plain_setting(scene->second);
  }
  if (shared.contains("image.width") && shared.contains("image.height")) {
    text += fmt::format("{}{} x {} pixels", text.empty() ? "" : ", ", shared.at("image.width"),
                        shared.at("image.height"));
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

}  // namespace

ReportData sweep_report(const ReportPoints& sweep, std::optional<double> budget) {
  const Chosen chosen = choose(sweep, budget);
  const std::optional<std::size_t> axis = first_axis(sweep);
  ReportData report;
  report.kind = "sweep";
  report.title = "Sweep of " + tables::counted(sweep.points.size(), "machine");
  report.about = about_sweep(sweep);
  report.answer = answer_of(sweep, chosen);
  report.explorer = explorer_json(sweep, chosen, axis);
  if (axis) {
    add_explored("frame_time", "Frame time", sweep.axes[*axis],
                 {{"FIGURE", "ms"}, {"TITLE", "frame time, ms"}}, report);
    drop_ideal(report.charts.back().spec);
    add_explored("speed_up", "Speed-up", sweep.axes[*axis], {{"FIGURE", "speed_up"}, {"TITLE", "speed-up"}},
                 report);
  }
  if (sweep.points.size() > 1) {
    add_front(sweep, "price", sweep.priced ? "price" : "number of nodes", sweep.priced ? "price" : "nodes",
              report);
    if (!chosen.energy_front.empty()) {
      add_front(sweep, "energy", "energy", "energy of a frame, mJ", report);
    }
  }
  if (axis) {
    for (const SliceChart& slice : charts_over_axis()) {
      add_slice(sweep, slice, std::nullopt, *axis,
                slice.what.empty() ? std::string(slice.name) : slice.what + "_" + std::string(slice.name),
                report);
    }
  }
  const SliceChart hit_ratios = {
      "hit_ratio",
      "Hit ratio",
      "Of all references of the first level, and by kind of record; those of the other kinds are in the "
      "figures of a chosen point.",
      {"hit_ratio", "hit_ratio_node", "hit_ratio_list", "hit_ratio_primitive"}};
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    if (bears_on_caches(sweep.axes[i].name)) {
      add_slice(sweep, hit_ratios, i, i, "hit_ratio_" + plain_name(sweep.axes[i].name), report);
    }
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
