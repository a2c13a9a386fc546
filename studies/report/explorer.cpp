#include "studies/report/explorer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/report/cycle_groups.h"
#include "studies/report/rounded.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

constexpr double ms_a_ps = 1e-9;
constexpr double us_a_ps = 1e-6;

Cell cell_of(double value) { return std::isfinite(value) ? Cell(value) : Cell(); }

double factor_of(const ModelError* errors, Zone zone) {
  return 1.0 + errors[static_cast<std::size_t>(zone)].p95;
}

// The slope of the ideal speed-up on an axis of nodes: nodes for each unit of the axis; 0 on other axes.
double ideal_of(const ReportPoint& point, const ReportAxis& axis, std::size_t place) {
  const double efficiency = point.figure("efficiency");
  return axis.name == "machine.nodes" && efficiency > 0.0
             ? point.figure("speed_up") / efficiency / axis.number(place)
             : 0.0;
}

Json error_json(const ModelError* errors) {
  Json json = Json::object();
  for (const Zone zone : {Zone::between, Zone::beyond}) {
    const ModelError& error = errors[static_cast<std::size_t>(zone)];
    json[zone == Zone::between ? "between" : "beyond"] = {
        {"points", error.points}, {"mean", error.mean}, {"p95", error.p95}, {"known", error.is_known()}};
  }
  return json;
}

Json model_json(const AxisModel& model) {
  Json json = {{"note", error_note(&model)},
               {"x", Json::array()},
               {"error", error_json(model.end)},
               {"speed_up_error", error_json(model.speed_up)},
               {"curves", Json::object()}};
  for (const double x : model.x) {
    json["x"].push_back(x);
  }
  for (const auto& [key, curve] : model.curves) {
    Json ms = Json::array();
    Json base = Json::array();
    Json bound = Json::array();
    bool one_base = true;
    double first_base = -1.0;
    for (const std::optional<Modelled>& sample : curve.samples) {
      ms.push_back(sample ? Json(rounded(sample->end * ms_a_ps, curve_digits)) : Json());
      base.push_back(sample ? Json(rounded(sample->base_end * ms_a_ps, place_digits)) : Json());
      bound.push_back(sample ? Json(rounded(sample->asymptote * ms_a_ps, curve_digits)) : Json());
      if (sample) {
        first_base = first_base < 0.0 ? sample->base_end : first_base;
        one_base = one_base && std::abs(sample->base_end - first_base) <= 1e-9 * first_base;
      }
    }
    Json each = {{"ms", ms}, {"bound", bound}};
    each["base"] = one_base ? Json(rounded(std::max(first_base, 0.0) * ms_a_ps, place_digits)) : base;
    if (curve.saturation) {
      each["saturation"] = *curve.saturation;
    }
    json["curves"][key] = each;
  }
  return json;
}

Table rows_table() {
  return {"explorer",
          "Frame time and speed-up",
          {{"kind", ColumnType::text, "", "exact point, model, saturation or zone of extrapolation"},
           {"zone", ColumnType::text, "", "between exact points, below or above them"},
           {"x", ColumnType::real, "", "place on the axis"},
           {"x2", ColumnType::real, "", "end of a zone"},
           {"ms", ColumnType::real, "ms", "frame time"},
           {"ms_low", ColumnType::real, "ms", "lower end of the error band"},
           {"ms_high", ColumnType::real, "ms", "upper end of the error band"},
           {"ms_bound", ColumnType::real, "ms", "no frame is shorter (asymptotic bound)"},
           {"speed_up", ColumnType::real, "1", "speed-up over the base machine"},
           {"speed_up_low", ColumnType::real, "1", "lower end of the error band"},
           {"speed_up_high", ColumnType::real, "1", "upper end of the error band"},
           {"speed_up_bound", ColumnType::real, "1", "no speed-up is larger (asymptotic bound)"},
           {"ideal", ColumnType::real, "1", "speed-up that is the number of nodes"}}};
}

void add_sample(Table& table, const AxisModel& model, const Modelled& sample, double x, Zone zone,
                const std::string& zone_name, double ideal) {
  const double ms = sample.end * ms_a_ps;
  const double factor = factor_of(model.end, zone);
  const bool has_speed_up =
      sample.base_end > 0.0 && model.speed_up[static_cast<std::size_t>(zone)].is_known();
  const double speed_up = has_speed_up ? sample.base_end / sample.end : NAN;
  const double speed_factor = factor_of(model.speed_up, zone);
  table.add_row({"model", zone_name, x, Cell(), ms, ms / factor, ms * factor, sample.asymptote * ms_a_ps,
                 cell_of(speed_up), cell_of(speed_up / speed_factor), cell_of(speed_up * speed_factor),
                 cell_of(has_speed_up && sample.asymptote > 0.0 ? sample.base_end / sample.asymptote : NAN),
                 ideal > 0.0 ? Cell(ideal * x) : Cell()});
}

// The outer points are rows of both zones, so that the zones' curves meet.
void add_model_rows(Table& table, const AxisModel& model, const ModelCurve& curve, double first, double last,
                    double ideal) {
  for (std::size_t i = 0; i < model.x.size(); ++i) {
    if (!curve.samples[i]) {
      continue;
    }
    const double x = model.x[i];
    if (x <= first && model.has_band(Zone::beyond)) {
      add_sample(table, model, *curve.samples[i], x, Zone::beyond, "below", ideal);
    }
    if (x >= first && x <= last && model.has_band(Zone::between)) {
      add_sample(table, model, *curve.samples[i], x, Zone::between, "between", ideal);
    }
    if (x >= last && model.has_band(Zone::beyond)) {
      add_sample(table, model, *curve.samples[i], x, Zone::beyond, "above", ideal);
    }
  }
}

void add_mark(Table& table, const std::string& kind, const std::string& zone, double x, Cell x2) {
  std::vector<Cell> row(table.columns().size());
  row[0] = kind;
  row[1] = zone;
  row[2] = x;
  row[3] = std::move(x2);
  table.add_row(std::move(row));
}

// Adds the ranges in which the curve extrapolates, and the place from which a queue limits.
void add_zones(Table& table, const AxisModel& model, const ModelCurve& curve, double first, double last) {
  double low = first;
  double high = last;
  for (std::size_t i = 0; i < model.x.size(); ++i) {
    if (curve.samples[i]) {
      low = std::min(low, model.x[i]);
      high = std::max(high, model.x[i]);
    }
  }
  if (low < first) {
    add_mark(table, "zone", "below", low, first);
  }
  if (high > last) {
    add_mark(table, "zone", "above", last, high);
  }
  if (curve.saturation && *curve.saturation >= low && *curve.saturation <= high) {
    add_mark(table, "saturation", "", *curve.saturation, Cell());
  }
}

}  // namespace

std::optional<double> shown(const ExplorerField& field, const ReportPoint& point) {
  if (!point.has(field.name)) {
    return std::nullopt;
  }
  const double value = point.figure(field.name) * field.scale;
  return field.exact ? value : rounded(value, figure_digits);
}

std::vector<ExplorerField> explorer_fields(const ReportPoints& sweep) {
  std::vector<ExplorerField> fields = {
      {"end", "ms", "frame time", ms_a_ps, true},
      {"speed_up", "1", "speed-up over the base machine", 1.0, true},
      {"efficiency", "fraction", "speed-up by the number of nodes", 1.0, true},
      {"times_faster", "1", "frame time of the machine of [sweep.compare] by this one's"},
      {"price", "1", sweep.priced ? "cost by [prices]" : "number of nodes"},
      {"hit_ratio", "fraction", "hits by all references"},
      {"hit_ratio_node", "fraction", "of node records"},
      {"hit_ratio_list", "fraction", "of lists"},
      {"hit_ratio_primitive", "fraction", "of primitives"},
      {"hit_ratio_material", "fraction", "of materials"},
      {"interconnect_utilisation", "fraction",
       "busy time of the busiest cluster's interconnect by the frame time"},
      {"bank_utilisation", "fraction", "busy time of the busiest bank by the frame time"},
      {"network_utilisation", "fraction", "busy time of the network's links by the frame time"},
      {"mean_interconnect_wait", "us", "mean wait for the interconnect", us_a_ps},
      {"interconnect_wait_p50", "us", "half of the waits for the interconnect are not longer", us_a_ps},
      {"interconnect_wait_p95", "us", "95 % of the waits for the interconnect are not longer", us_a_ps},
      {"interconnect_wait_p99", "us", "99 % of the waits for the interconnect are not longer", us_a_ps},
      {"mean_bank_wait", "us", "mean wait for a bank", us_a_ps},
      {"bank_wait_p50", "us", "half of the waits for a bank are not longer", us_a_ps},
      {"bank_wait_p95", "us", "95 % of the waits for a bank are not longer", us_a_ps},
      {"bank_wait_p99", "us", "99 % of the waits for a bank are not longer", us_a_ps}};
  for (const std::string_view group : cycle_group_names) {
    fields.push_back({"part_" + std::string(group), "fraction", "share of the nodes' time"});
  }
  std::erase_if(fields, [&](const ExplorerField& field) {
    return std::none_of(sweep.points.begin(), sweep.points.end(),
                        [&](const ReportPoint& point) { return point.has(field.name); });
  });
  return fields;
}

Table explorer_rows(const ReportPoints& sweep, const AxisModel* model, std::size_t axis,
                    const ReportPoint& through) {
  Table table = rows_table();
  const std::string key = line_key(through, axis);
  double ideal = 0.0;
  double first = INFINITY;
  double last = -INFINITY;
  std::vector<const ReportPoint*> line;
  for (const ReportPoint& point : sweep.points) {
    if (line_key(point, axis) == key) {
      line.push_back(&point);
      first = std::min(first, sweep.axes[axis].number(point.place[axis]));
      last = std::max(last, sweep.axes[axis].number(point.place[axis]));
      ideal = std::max(ideal, ideal_of(point, sweep.axes[axis], point.place[axis]));
    }
  }
  std::sort(line.begin(), line.end(),
            [&](const ReportPoint* a, const ReportPoint* b) { return a->place[axis] < b->place[axis]; });
  if (model != nullptr) {
    if (const auto curve = model->curves.find(key); curve != model->curves.end()) {
      add_zones(table, *model, curve->second, first, last);
      add_model_rows(table, *model, curve->second, first, last, ideal);
    }
  }
  for (const ReportPoint* point : line) {
    const double x = sweep.axes[axis].number(point->place[axis]);
    std::vector<Cell> row(table.columns().size());
    row[0] = "exact";
    row[1] = "between";
    row[2] = x;
    row[4] = point->figure("end") * ms_a_ps;
    row[8] = point->has("speed_up") ? Cell(point->figure("speed_up")) : Cell();
    row[12] = ideal > 0.0 ? Cell(ideal * x) : Cell();
    table.add_row(std::move(row));
  }
  return table;
}

Json channel_of(const ReportAxis& axis) {
  Json channel = {
      {"title", axis.unit.empty() || axis.unit == "1" ? axis.name : axis.name + ", " + axis.unit}};
  for (const std::string& follower : axis.followers) {
    channel["title"] = channel["title"].get<std::string>() + ", with " + follower;
  }
  channel["scale"] = axis.logarithmic ? Json{{"type", "log"}, {"nice", false}}
                                      : Json{{"type", "linear"}, {"zero", false}, {"nice", false}};
  Json values = Json::array();
  for (std::size_t i = 0; axis.numeric && i < axis.values.size(); ++i) {
    values.push_back(axis.number(i));
  }
  // The labels are the sweep's own texts; JSON's quoting is that of Vega's expressions too.
  Json texts = axis.texts;
  channel["axis"] = {{"values", values},
                     {"labelOverlap", true},
                     {"grid", false},
                     {"labelExpr", texts.dump(-1, ' ', true, Json::error_handler_t::replace) + "[indexof(" +
                                       values.dump() + ", datum.value)]"}};
  return channel;
}

Json explorer_json(const ReportPoints& sweep, std::span<const AxisModel> models, const Chosen& chosen,
                   std::size_t axis) {
  Json json = {
      {"axis", axis}, {"start", chosen.knee}, {"fastest", chosen.fastest}, {"no_model", error_note(nullptr)}};
  json["axes"] = Json::array();
  json["place"] = Json::array();
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    const ReportAxis& each = sweep.axes[i];
    Json values = Json::array();
    for (std::size_t v = 0; each.numeric && v < each.values.size(); ++v) {
      values.push_back(each.number(v));
    }
    json["axes"].push_back({{"name", each.name},
                            {"followers", each.followers},
                            {"texts", each.texts},
                            {"values", values},
                            {"numeric", each.numeric},
                            {"integer", each.integer},
                            {"logarithmic", each.logarithmic},
                            {"unit", each.unit}});
    if (each.numeric) {
      json["axes"].back()["x"] = channel_of(each);
    }
    Json place = Json::array();
    for (const ReportPoint& point : sweep.points) {
      place.push_back(point.place[i]);
    }
    json["place"].push_back(std::move(place));
  }
  Json ordinals = Json::array();
  for (const ReportPoint& point : sweep.points) {
    ordinals.push_back(point.ordinal);
  }
  json["ordinal"] = std::move(ordinals);
  json["front"] = chosen.front;
  json["fields"] = Json::array();
  json["columns"] = Json::object();
  for (const ExplorerField& field : explorer_fields(sweep)) {
    json["fields"].push_back(
        {{"name", field.name}, {"unit", field.unit}, {"description", field.description}});
    Json column = Json::array();
    for (const ReportPoint& point : sweep.points) {
      const std::optional<double> value = shown(field, point);
      column.push_back(value ? Json(*value) : Json());
    }
    json["columns"][field.name] = std::move(column);
  }
  json["models"] = Json::object();
  for (const AxisModel& model : models) {
    json["models"][std::to_string(model.axis)] = model_json(model);
  }
  return json;
}

}  // namespace marti::studies
