#include "studies/report/model/explorer.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

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

constexpr double ps_a_us = 1e6;
constexpr std::string_view price =
    "price";  // the cost, or the number of nodes: the only field that is no figure

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

ExplorerField field_of(const std::string& name) {
  const std::string& unit = figures::figure_named(name).unit;
  if (unit == "ps") {
    return {name, "ms", 1e9};
  }
  return unit == "fJ" ? ExplorerField{name, "mJ", 1e12}
                      : ExplorerField{name, unit == "fraction" || unit == "text" ? "1" : unit};
}

// What the page shows of each point, whatever else it has: for charts, for the table, for the answer.
std::vector<ExplorerField> first_fields() {
  std::vector<ExplorerField> fields;
  const auto add = [&fields](const std::string& name, const std::string& title = {}) {
    fields.push_back(name == price ? ExplorerField{name} : field_of(name));
    fields.back().title = title;
  };
  const auto add_main = [&](const std::string& name, bool exact, const std::string& title = {}) {
    add(name, title);
    fields.back().main = true;
    fields.back().exact = exact;
  };
  add_main("end", true, "frame time");
  add_main("speed_up", true, "speed-up");
  add_main(std::string(price), true);
  add_main("efficiency", true);
  add("times_faster");
  add_main("energy", true);
  add_main("hit_ratio", false);
  for (const std::string_view kind : memory::record_kind_names) {
    add("hit_ratio_" + std::string(kind));
  }
  for (const std::string part : {"interconnect", "bank", "network"}) {
    add_main(part + "_utilisation", false, part + " busy");
  }
  for (const std::string wait : {"interconnect_wait", "bank_wait"}) {
    for (const std::string& name : {"mean_" + wait, wait + "_p50", wait + "_p95", wait + "_p99"}) {
      add(name);
      fields.back().unit = "us";
      fields.back().divisor = ps_a_us;
    }
  }
  for (const std::string_view activity : processors::cost::activity_names) {
    add("share_" + std::string(activity));
  }
  add("bound", "asymptotic bound");
  add("saturation");
  return fields;
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
  std::vector<ExplorerField> fields = first_fields();
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

Json field_json(const ExplorerField& field, const ReportPoints& sweep) {
  const bool is_price = field.name == price;
  Json json = {{"name", field.name},
               {"unit", field.unit},
               {"title", !field.title.empty()        ? field.title
                         : is_price && !sweep.priced ? "nodes"
                                                     : words(field.name)}};
  if (is_price) {
    json["meaning"] = sweep.priced ? "cost by [prices]" : "number of nodes, as all costs are equal";
  } else {
    const figures::FigureEntry& figure = figures::figure_named(field.name);
    json["meaning"] = figure.description;
    if (figure.unit == "fraction") {  // a part of a whole, which people read in percent
      json["percent"] = true;
    }
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

std::vector<std::string> first_figures() {
  std::vector<std::string> names = sim::mapped(first_fields(), &ExplorerField::name);
  std::erase(names, price);
  return names;
}

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
