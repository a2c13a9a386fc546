#include "studies/report/model/explorer.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "memory/record_kind.h"
#include "processors/cost/accounting.h"
#include "sim/mapped.h"
#include "sim/rounded.h"
#include "studies/figures/counted_figures.h"
#include "studies/figures/derived_figures.h"
#include "studies/report/model/answer_text.h"
#include "studies/report/model/digits.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr double ps_a_ms = 1e9;
constexpr double ps_a_us = 1e6;
constexpr double fj_a_mj = 1e12;

/// A figure of every point that the page has.
struct ExplorerField {
  std::string name;        // as in ReportPoint::figures
  std::string unit = "1";  // as shown
  double divisor =
      1.0;             // shown is the figure by this: a whole number, so that all digits are the figure's own
  bool exact = false;  // all its digits are shown
  bool main = false;   // has a column in the table of points
  std::string title{};  // for people; empty: the name in words
};

// How a figure of the catalogue is shown that has no entry of its own.
ExplorerField field_of(const std::string& name) {
  const std::string& unit = figures::figure_named(name).unit;
  if (unit == "ps") {
    return {name, "ms", ps_a_ms};
  }
  return unit == "fJ" ? ExplorerField{name, "mJ", fj_a_mj}
                      : ExplorerField{name, unit == "fraction" || unit == "text" ? "1" : unit};
}

// Whether the points' values of a figure are not all equal.
bool varies(const ReportPoints& sweep, const std::string& name) {
  const ReportPoint& first = sweep.points.front();
  return std::ranges::any_of(sweep.points, [&](const ReportPoint& point) {
    return point.has(name) != first.has(name) || point.figure(name) != first.figure(name);
  });
}

// The fields that at least one point has: those that charts and the table need, then all figures of the
// points that tell machines apart.
std::vector<ExplorerField> explorer_fields(const ReportPoints& sweep) {
  std::vector<ExplorerField> fields = {{"end", "ms", ps_a_ms, true, true, "frame time"},
                                       {"speed_up", "1", 1.0, true, true, "speed-up"},
                                       {"price", "1", 1.0, true, true, sweep.priced ? "price" : "nodes"},
                                       {"efficiency", "1", 1.0, true, true},
                                       {"times_faster"},
                                       {"energy", "mJ", 1.0, true, true},
                                       {"hit_ratio", "1", 1.0, false, true}};
  for (const std::string_view kind : memory::record_kind_names) {
    fields.push_back({"hit_ratio_" + std::string(kind)});
  }
  for (const char* const part : {"interconnect", "bank", "network"}) {
    fields.push_back(
        {part + std::string("_utilisation"), "1", 1.0, false, true, part + std::string(" busy")});
  }
  for (const std::string wait : {"interconnect_wait", "bank_wait"}) {
    for (const std::string& name : {"mean_" + wait, wait + "_p50", wait + "_p95", wait + "_p99"}) {
      fields.push_back({name, "us", ps_a_us});
    }
  }
  for (const std::string_view activity : processors::cost::activity_names) {
    fields.push_back({"share_" + std::string(activity)});
  }
  fields.push_back({"bound", "ms", ps_a_ms, false, false, "asymptotic bound"});
  fields.push_back({"saturation", "1", 1.0, false, false, "saturation"});
  std::erase_if(fields, [&](const ExplorerField& field) {
    const bool share = field.name.starts_with("share_");  // what nodes never do needs no column
    return std::ranges::none_of(sweep.points, [&](const ReportPoint& point) {
      return point.has(field.name) && !(share && point.figure(field.name) == 0.0);
    });
  });
  std::set<std::string, std::less<>> known = {"cost"};  // shown as the price
  for (const ExplorerField& field : fields) {
    known.insert(field.name);
  }
  for (const auto& entries : {figures::derived_figures(), figures::counted_figures()}) {
    for (const figures::FigureEntry& figure : entries) {
      if (!known.contains(figure.name) && figure.of_machine() && varies(sweep, figure.name)) {
        fields.push_back(field_of(figure.name));
      }
    }
  }
  return fields;
}

// Prices, bounds and percentiles are not in the catalogue of figures; the report itself works them out.
constexpr std::pair<std::string_view, std::string_view> own_meanings[] = {
    {"bound", "no frame with these counters is shorter"},
    {"saturation", "nodes of a cluster from which on its busiest queue is full"}};
constexpr std::string_view percentile_part = "_wait_p";

std::string_view own_meaning_of(std::string_view name) {
  for (const auto& [own, meaning] : own_meanings) {
    if (own == name) {
      return meaning;
    }
  }
  return {};
}

bool is_catalogued(const ExplorerField& field) {
  return field.name != "price" && own_meaning_of(field.name).empty() &&
         field.name.find(percentile_part) == std::string::npos;
}

// Parts of a whole, which people read in percent.
bool is_share(const ExplorerField& field) {
  return is_catalogued(field) && figures::figure_named(field.name).unit == "fraction";
}

std::string meaning_of(const ExplorerField& field, const ReportPoints& sweep) {
  if (is_catalogued(field)) {
    return figures::figure_named(field.name).description;
  }
  if (const std::string_view own = own_meaning_of(field.name); !own.empty()) {
    return std::string(own);
  }
  if (field.name == "price") {
    return sweep.priced ? "cost by [prices]" : "number of nodes, as all costs are equal";
  }
  return "percentile: the upper end of its bucket of the histogram, at most an eighth too long";
}

Json field_json(const ExplorerField& field, const ReportPoints& sweep) {
  Json json = {{"name", field.name},
               {"unit", field.unit},
               {"title", field.title.empty() ? words(field.name) : field.title},
               {"meaning", meaning_of(field, sweep)}};
  if (is_share(field)) {
    json["percent"] = true;
  }
  if (field.main) {
    json["main"] = true;
  }
  return json;
}

// The figure as it is shown, for each point; null where the point lacks it.
Json column_of(const ExplorerField& field, const ReportPoints& sweep) {
  Json column = Json::array();
  for (const ReportPoint& point : sweep.points) {
    const double value = point.figure(field.name) / field.divisor;
    column.push_back(!point.has(field.name) ? Json()
                                            : Json(field.exact ? value : sim::rounded(value, figure_digits)));
  }
  return column;
}

// The axis that colours show at first: names that are told apart in one chart of lines.
std::optional<std::size_t> colour_axis(const ReportPoints& sweep, std::optional<std::size_t> axis) {
  constexpr std::size_t most_lines = 4;
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    if (i != axis && !sweep.axes[i].numeric && sweep.axes[i].values.size() <= most_lines) {
      return i;
    }
  }
  return std::nullopt;
}

Json numbers_of(const ReportAxis& axis) {
  Json numbers = Json::array();
  for (std::size_t i = 0; axis.numeric && i < axis.values.size(); ++i) {
    numbers.push_back(axis.number(i));
  }
  return numbers;
}

// Sizes, frequencies and durations have their unit beside each value: "16 KiB".
bool has_units(const ReportAxis& axis) {
  return axis.unit == "byte" || axis.unit == "Hz" || axis.unit == "ps";
}

// The x channel of Vega-Lite for an axis of numbers: title, scale, and the values as labels.
Json channel_of(const ReportAxis& axis) {
  const bool bare = axis.unit.empty() || axis.unit == "1" || has_units(axis);
  Json channel = {{"title", bare ? axis.name : axis.name + ", " + axis.unit}};
  channel["scale"] = axis.logarithmic ? Json{{"type", "log"}, {"nice", false}}
                                      : Json{{"type", "linear"}, {"zero", false}, {"nice", false}};
  const Json values = numbers_of(axis);
  // The labels are the sweep's own texts; JSON's quoting is that of Vega's expressions too.
  Json texts = axis.texts;
  channel["axis"] = {{"values", values},
                     {"labelOverlap", true},
                     {"grid", false},
                     {"labelExpr", texts.dump(-1, ' ', true, Json::error_handler_t::replace) + "[indexof(" +
                                       values.dump() + ", datum.value)]"}};
  return channel;
}

}  // namespace

Json explorer_json(const ReportPoints& sweep, const Chosen& chosen, std::optional<std::size_t> axis) {
  Json json = {{"axis", axis ? Json(*axis) : Json()},
               {"start", chosen.knee},
               {"fastest", chosen.fastest},
               {"price", sweep.priced ? "price" : "nodes"},
               {"budget", chosen.budget ? Json(*chosen.budget) : Json()}};
  const std::optional<std::size_t> colour = colour_axis(sweep, axis);
  json["colour"] = colour ? Json(*colour) : Json();
  json["axes"] = Json::array();
  json["place"] = Json::array();
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    const ReportAxis& each = sweep.axes[i];
    json["axes"].push_back({{"name", each.name},
                            {"followers", each.followers},
                            {"texts", each.texts},
                            {"values", numbers_of(each)},
                            {"numeric", each.numeric},
                            {"logarithmic", each.logarithmic},
                            {"unit", each.unit}});
    if (each.numeric) {
      json["axes"].back()["x"] = channel_of(each);
    }
    json["place"].push_back(
        sim::mapped(sweep.points, [&](const ReportPoint& point) { return point.place[i]; }));
  }
  json["ordinal"] = sim::mapped(sweep.points, &ReportPoint::ordinal);
  json["fronts"] = {{"price", chosen.front}, {"energy", chosen.energy_front}};
  json["fields"] = Json::array();
  json["columns"] = Json::object();
  for (const ExplorerField& field : explorer_fields(sweep)) {
    json["fields"].push_back(field_json(field, sweep));
    json["columns"][field.name] = column_of(field, sweep);
  }
  return json;
}

}  // namespace marti::studies::report
