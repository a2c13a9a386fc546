// The report of a sweep's directory.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "studies/report/chart_library.h"
#include "studies/report/explorer.h"
#include "studies/report/report_files.h"
#include "studies/report/report_kinds.h"
#include "studies/report/sweep_answer.h"
#include "studies/report/sweep_model.h"
#include "studies/report/sweep_points.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

// A chart of exact points only: figures over an axis.
struct SliceChart {
  std::string_view name;  // of chart and specification
  std::string_view title;
  std::string_view note;
  std::vector<std::string> fields;
};

std::vector<SliceChart> charts_over_nodes() {
  std::vector<std::string> parts;
  for (const char* part : {"traversal", "intersection", "shading_and_building", "cache_access_and_switching",
                           "transfer_and_bank", "interconnect_wait", "bank_wait", "other_waits", "idle"}) {
    parts.push_back(std::string("part_") + part);
  }
  return {
      {"efficiency",
       "Efficiency",
       "Speed-up by the number of nodes; 100 % is the dashed line.",
       {"efficiency"}},
      {"cycles", "Where the cycles go",
       "All nodes' time from 0 to the end of the frame; it adds up to 100 %.", parts},
      {"utilisation",
       "How busy the shared parts are",
       "What comes near 100 % limits the machine.",
       {"interconnect_utilisation", "bank_utilisation", "network_utilisation"}},
      {"waits",
       "How long nodes wait for shared parts",
       "Means are exact; a percentile is the upper end of its bucket of the histogram, at most an eighth too "
       "long.",
       {"mean_interconnect_wait", "interconnect_wait_p50", "interconnect_wait_p95", "interconnect_wait_p99",
        "mean_bank_wait", "bank_wait_p50", "bank_wait_p95", "bank_wait_p99"}}};
}

const std::vector<std::string>& hit_ratios() {
  static const std::vector<std::string> names = {"hit_ratio", "hit_ratio_node", "hit_ratio_list",
                                                 "hit_ratio_primitive", "hit_ratio_material"};
  return names;
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

class Charts {
 public:
  Charts(const ReportPoints& sweep, const ReportPoint& through, ReportData& report)
      : sweep_(sweep), through_(through), report_(report), fields_(explorer_fields(sweep)) {}

  void add_explorer(const AxisModel* model, std::size_t axis) {
    const Table rows = explorer_rows(sweep_, model, axis, through_);
    for (const auto& [name, title] :
         {std::pair("frame_time", "Frame time"), std::pair("speed_up", "Speed-up")}) {
      ReportChart chart = make_chart(name, rows, error_note(model));
      chart.name = name;
      chart.title = fmt::format("{} over {}", title, sweep_.axes[axis].name);
      chart.spec["title"] = chart.title;
      chart.spec["encoding"]["x"].update(channel_of(sweep_.axes[axis]), true);
      chart.live = {{"rows", "explorer"}, {"title", title}};
      report_.charts.push_back(std::move(chart));
    }
  }

  void add_slice(const SliceChart& slice, std::size_t axis, const std::string& name) {
    std::vector<const ExplorerField*> present;
    for (const std::string& field : slice.fields) {
      const auto at = std::find_if(fields_.begin(), fields_.end(),
                                   [&](const ExplorerField& each) { return each.name == field; });
      if (at != fields_.end()) {
        present.push_back(&*at);
      }
    }
    if (present.empty()) {
      return;
    }
    const ReportAxis& along = sweep_.axes[axis];
    std::vector<Column> columns = {{"value", ColumnType::text, "", along.name}};
    Json names = Json::array();
    for (const ExplorerField* field : present) {
      columns.push_back({field->name, ColumnType::real, field->unit, field->description});
      names.push_back(field->name);
    }
    Table table(name, fmt::format("{} over {}", slice.title, along.name), columns);
    for (const ReportPoint* point : line_of(axis)) {
      std::vector<Cell> row = {along.texts[point->place[axis]]};
      for (const ExplorerField* field : present) {
        const std::optional<double> value = shown(*field, *point);
        row.push_back(value ? Cell(*value) : Cell());
      }
      table.add_row(std::move(row));
    }
    ReportChart chart = make_chart(slice.name, table, std::string(slice.note));
    set_x_title(chart.spec, along);
    keep_folded(chart.spec, names);
    chart.live = {{"rows", "slice"}, {"axis", axis}, {"fields", names}};
    report_.charts.push_back(std::move(chart));
  }

  void add_prices(const Chosen& chosen) {
    Table table("price", sweep_.priced ? "Frame time and price" : "Frame time and number of nodes",
                {{"ordinal", ColumnType::integer, "1", "number of the point"},
                 {"price", ColumnType::real, "1", "cost by [prices], or the number of nodes"},
                 {"ms", ColumnType::real, "ms", "frame time"},
                 {"front", ColumnType::integer, "1", "1: no other beats it in price and time"}});
    for (std::size_t i = 0; i < sweep_.points.size(); ++i) {
      const ReportPoint& point = sweep_.points[i];
      const bool front = std::find(chosen.front.begin(), chosen.front.end(), i) != chosen.front.end();
      table.add_row({point.ordinal, point.figure("price"), point.figure("end") * 1e-9, std::int64_t{front}});
    }
    ReportChart chart = make_chart(
        "price", table, "Every machine of the sweep; the line joins those that no other beats in both.");
    chart.spec["encoding"]["x"]["title"] = sweep_.priced ? "price" : "nodes";
    const bool has_free = std::any_of(sweep_.points.begin(), sweep_.points.end(),
                                      [](const ReportPoint& point) { return point.figure("price") <= 0.0; });
    if (has_free) {
      chart.spec["encoding"]["x"]["scale"] = {{"type", "linear"}, {"nice", false}};
    }
    chart.live = {{"rows", "all"}};
    report_.charts.push_back(std::move(chart));
  }

 private:
  [[nodiscard]] std::vector<const ReportPoint*> line_of(std::size_t axis) const {
    std::vector<const ReportPoint*> line;
    for (const ReportPoint& point : sweep_.points) {
      if (line_key(point, axis) == line_key(through_, axis)) {
        line.push_back(&point);
      }
    }
    std::sort(line.begin(), line.end(),
              [axis](const ReportPoint* a, const ReportPoint* b) { return a->place[axis] < b->place[axis]; });
    return line;
  }

  // A figure that no machine of the sweep has gets no place in the legend.
  static void keep_folded(Json& spec, const Json& names) {
    const auto is_missing = [&](const Json& name) {
      return std::find(names.begin(), names.end(), name) == names.end();
    };
    if (!spec.contains("transform") || !spec["transform"][0].contains("fold")) {
      return;
    }
    Json& folded = spec["transform"][0]["fold"];
    for (std::size_t i = folded.size(); i-- > 0;) {
      if (!is_missing(folded[i])) {
        continue;
      }
      for (const char* channel : {"color", "shape"}) {
        if (spec["encoding"].contains(channel)) {
          Json& scale = spec["encoding"][channel]["scale"];
          for (const char* part : {"domain", "range"}) {
            if (scale.contains(part) && scale[part].size() == folded.size()) {
              scale[part].erase(i);
            }
          }
        }
      }
      folded.erase(i);
    }
  }

  // In a layered chart each layer has its own title of the x axis.
  static void set_x_title(Json& spec, const ReportAxis& axis) {
    for (Json* view : {&spec}) {
      if (view->contains("encoding") && (*view)["encoding"].contains("x")) {
        (*view)["encoding"]["x"]["title"] = axis.name;
      }
      if (view->contains("layer")) {
        for (Json& layer : (*view)["layer"]) {
          set_x_title(layer, axis);
        }
      }
    }
  }

  const ReportPoints& sweep_;
  const ReportPoint& through_;
  ReportData& report_;
  std::vector<ExplorerField> fields_;
};

Table front_table(const ReportPoints& sweep, const Chosen& chosen) {
  Table table("front", "Machines that no other beats in price and frame time",
              {{"ordinal", ColumnType::integer, "1", "number of the point in the sweep, from 0"},
               {"machine", ColumnType::text, "", "its values"},
               {"price", ColumnType::real, "1", sweep.priced ? "cost by [prices]" : "number of nodes"},
               {"ms", ColumnType::real, "ms", "frame time"},
               {"speed_up", ColumnType::real, "1", "over the base machine"},
               {"efficiency", ColumnType::real, "fraction", "speed-up by the number of nodes"},
               {"limit", ColumnType::text, "", "what takes most of its nodes' time"}});
  for (const std::size_t i : chosen.front) {
    const ReportPoint& point = sweep.points[i];
    const auto cell = [&](const char* name) { return point.has(name) ? Cell(point.figure(name)) : Cell(); };
    table.add_row({point.ordinal, place_text(sweep, point), point.figure("price"), point.figure("end") * 1e-9,
                   cell("speed_up"), cell("efficiency"), limit_sentence(point)});
  }
  return table;
}

Table error_table(const ReportPoints& sweep, std::span<const AxisModel> models) {
  Table table("model_error", "Error of the analytic model, measured by leaving exact points out",
              {{"axis", ColumnType::text, "", "key that the curve runs along"},
               {"figure", ColumnType::text, "", "what is modelled"},
               {"zone", ColumnType::text, "", "between exact points, or one step beyond them"},
               {"points", ColumnType::integer, "1", "points that were left out once"},
               {"mean", ColumnType::real, "fraction", "mean error"},
               {"p95", ColumnType::real, "fraction", "95th percentile, the band that is shown"}});
  for (const AxisModel& model : models) {
    for (const Zone zone : {Zone::between, Zone::beyond}) {
      for (const auto& [figure, errors] :
           {std::pair("frame time", model.end), std::pair("speed-up", model.speed_up)}) {
        const ModelError& error = errors[static_cast<std::size_t>(zone)];
        table.add_row({sweep.axes[model.axis].name, std::string(figure),
                       std::string(zone == Zone::between ? "between" : "beyond"),
                       static_cast<std::int64_t>(error.points), error.points > 0 ? Cell(error.mean) : Cell(),
                       error.points > 0 ? Cell(error.p95) : Cell()});
      }
    }
  }
  return table;
}

// The axis that the page begins with: nodes, else the first of numbers.
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
  return std::nullopt;
}

}  // namespace

ReportData read_sweep_report(const std::filesystem::path& directory) {
  const ReportPoints sweep = read_report_points(directory / "results.sqlite");
  const Chosen chosen = choose(sweep);
  const std::vector<AxisModel> models = model_sweep(sweep);
  ReportData report;
  report.kind = "sweep";
  report.title = fmt::format("Sweep of {} machines", sweep.points.size());
  report.answer = answer_of(sweep, chosen);
  Charts charts(sweep, sweep.points[chosen.knee], report);
  if (const std::optional<std::size_t> axis = first_axis(sweep)) {
    const auto model =
        std::find_if(models.begin(), models.end(), [&](const AxisModel& each) { return each.axis == *axis; });
    charts.add_explorer(model == models.end() ? nullptr : &*model, *axis);
    for (const SliceChart& slice : charts_over_nodes()) {
      charts.add_slice(slice, *axis, std::string(slice.name));
    }
    report.explorer = explorer_json(sweep, models, chosen, *axis);
  }
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    if (bears_on_caches(sweep.axes[i].name)) {
      charts.add_slice({"hit_ratio", "Hit ratio",
                        "Of all references of the first level, and by kind of record.", hit_ratios()},
                       i, "hit_ratio_" + plain_name(sweep.axes[i].name));
    }
  }
  if (sweep.points.size() > 1) {
    charts.add_prices(chosen);
  }
  constexpr std::size_t few = 12;
  report.tables.push_back({front_table(sweep, chosen), chosen.front.size() > few});
  if (!models.empty()) {
    report.tables.push_back({error_table(sweep, models), true});
  }
  for (const auto& [key, value] : sweep.settings) {
    report.configuration += key + " = " + value + "\n";
  }
  report.provenance = sweep.provenance;
  return report;
}

}  // namespace marti::studies
