#include "studies/show/lists.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/key_value.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "studies/figures/derived_figures.h"
#include "studies/run/frame_figures.h"

namespace marti::studies::show {

namespace {

std::string_view merge_of(const figures::FigureEntry& figure) {
  return figures::merge_names.at(static_cast<std::size_t>(figure.merge));
}
std::string_view better_of(const figures::FigureEntry& figure) {
  return figures::better_names.at(static_cast<std::size_t>(figure.better));
}

void list_text(std::string_view title, std::span<const figures::FigureEntry> figures, std::string& text) {
  std::size_t width = 0;
  for (const figures::FigureEntry& figure : figures) {
    width = std::max(width, figure.name.size());
  }
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}\n", title);
  for (const figures::FigureEntry& figure : figures) {
    fmt::format_to(out, "  {:<{}}  {:<8}  {:<7}  {:<6}  {}\n", figure.name, width, figure.unit,
                   merge_of(figure), better_of(figure), figure.description);
    if (figure.formula) {
      fmt::format_to(out, "  {:<{}}  = {}\n", "", width, figure.formula->text());
    }
  }
}

// What a figure has in common with others that are of other rays: "for shadow rays: transfers" and "for
// camera rays: transfers" are one line.
std::string common_description(const figures::FigureEntry& figure) {
  const std::size_t colon = figure.description.find(": ");
  return figure.description.starts_with("for ") && colon != std::string::npos
             ? "for these rays" + figure.description.substr(colon)
             : figure.description;
}

// A row of a table of figures: figures with the same meaning of other parts, which their names tell, share
// it.
struct Row {
  std::string names;
  std::string facts;    // unit, which is better and so on: all but names and meaning
  std::string formula;  // of the first; empty for counted figures
  std::string meaning;
  bool same_formula = true;
};

std::vector<Row> rows_of(std::span<const figures::FigureEntry> figures) {
  std::vector<Row> rows;
  for (const figures::FigureEntry& figure : figures) {
    Row row{"`" + figure.name + "`",
            figure.formula ? fmt::format("{} | {}", figure.unit, better_of(figure))
                           : fmt::format("{} | {} | {}", figure.unit, merge_of(figure), better_of(figure)),
            figure.formula ? "`" + figure.formula->text() + "`" : "", common_description(figure)};
    const auto known = std::ranges::find_if(
        rows, [&row](const Row& other) { return other.facts == row.facts && other.meaning == row.meaning; });
    if (known == rows.end()) {
      rows.push_back(std::move(row));
    } else {
      known->names += ", " + row.names;
      known->same_formula = known->same_formula && known->formula == row.formula;
    }
  }
  return rows;
}

// What stands before the first colon of a meaning: the part of the machine that a figure is of.
std::string part_of(const Row& row) {
  const std::size_t colon = row.meaning.find(": ");
  return colon == std::string::npos ? "" : row.meaning.substr(0, colon);
}

// A part of which several rows in a row are is said once, before them.
void list_counted(std::string_view title, std::span<const figures::FigureEntry> figures, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\n## {}\n\n| figure | unit | merge | better | what |\n|---|---|---|---|---|\n", title);
  const std::vector<Row> rows = rows_of(figures);
  std::string said;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string part = part_of(rows[i]);
    if (!part.empty() && part != said && i + 1 < rows.size() && part_of(rows[i + 1]) == part) {
      fmt::format_to(out, "| *{}:* |\n", part);
      said = part;
    } else if (part != said) {
      said.clear();
    }
    fmt::format_to(out, "| {} | {} | {} |\n", rows[i].names, rows[i].facts,
                   rows[i].meaning.substr(said.empty() ? 0 : said.size() + 2));
  }
}

// What the names stand for that formulas have.
std::string names_in_formulas() {
  std::map<std::string, std::string> names;
  for (const figures::FigureEntry& figure : figures::derived_figures()) {
    figure.formula->add_names(names);
  }
  std::string text;
  for (const auto& [name, what] : names) {
    if (!name.starts_with("more_")) {
      text += fmt::format("- `{}` is `{}`.\n", name, what);
    }
  }
  return text + "- `more_time_...` is the time less that of the base.\n";
}

}  // namespace

std::string list_figures_as_text() {
  std::string text = "name, unit, how parts make it, which is better, what it is\n\n";
  list_text("Machine, derived", figures::derived_figures(), text);
  text += names_in_formulas();
  list_text("\nMachine, counted", figures::counted_figures(), text);
  list_text("\nFrame", run::frame_figures(), text);
  return text;
}

std::string list_figures_as_markdown() {
  std::string text =
      "# Figures\n\n"
      "All figures of a machine and of a frame, as `marti figures --markdown` prints them. A figure has one "
      "name "
      "everywhere: in\n`result.json` (`figures.machine`, `figures.frame`), in the store of a sweep (tables "
      "`results` and `frame_results`, view\n`summary`), in `marti compare`, in `marti sweep --best`, in a "
      "report. Times are in ps. A figure has no value where the\nmachine has no such part or a denominator "
      "is "
      "0.\n\n"
      "*merge* says how the figures of nodes, clusters, banks and levels make the machine's: their *sum*, "
      "the "
      "*largest*, the\n*least*; *one*: a machine has only one. *better*: a machine with a lower or a higher "
      "value "
      "is the better one;\n*program*: the figure says how the program worked, not what the machine did. "
      "Equal "
      "machines may differ in it, a run and a\nsweep for one, and comparisons leave it out.\n\nCounts are "
      "exact integers. A sum over nodes of 2^63 or more is the nearest number of 53 bits, the same "
      "everywhere.\n"
      "\n## Derived figures of a machine\n\n"
      "Ratios are computed from merged figures, never stored. The *base* is the machine that the speed-up is "
      "measured against:\nin a run it is the same machine with one node. In formulas\n\n" +
      names_in_formulas() + "\n| figure | unit | better | formula | what |\n|---|---|---|---|---|\n";
  const auto out = std::back_inserter(text);
  for (const Row& row : rows_of(figures::derived_figures())) {
    fmt::format_to(out, "| {} | {} | {}{} | {} |\n", row.names, row.facts, row.formula,
                   row.same_formula ? "" : " and so on", row.meaning);
  }
  list_counted("Counted figures of a machine", figures::counted_figures(), text);
  list_counted("Figures of a frame", run::frame_figures(), text);
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

void require_any(const sim::Schema& schema, std::string_view only) {
  const auto keys = schema.keys();
  if (std::ranges::none_of(keys, [&](const sim::Key& key) { return sim::is_or_is_below(key, only); })) {
    throw sim::UserError("config: there is no key and no section \"" + sim::shown(only) + "\"" +
                         sim::did_you_mean(only, schema.names()) + "; `marti config` lists all keys");
  }
}

Json json_of_value(const sim::Value& value) {
  return std::visit([](const auto& content) { return Json(content); }, value);
}

Json json_of_key(const sim::Key& key) {
  Json value;
  if (key.is_list) {
    value = Json::array();
    for (const sim::Value& element : key.default_value) {
      value.push_back(json_of_value(element));
    }
  } else {
    value = json_of_value(key.default_value.front());
  }
  return {{"name", key.name},
          {"type", name_of(key.type)},
          {"list", key.is_list},
          {"default", value},
          {"minimum", json_of_bound(key.minimum)},
          {"maximum", json_of_bound(key.maximum)},
          {"choices", key.choices},
          {"unit", sim::unit_of(key)},
          {"meaning", key.meaning}};
}

}  // namespace

nlohmann::ordered_json json_of_bound(const std::optional<sim::Value>& bound) {
  return bound ? json_of_value(*bound) : Json();
}

std::string keys_as_text(const sim::Schema& schema, std::string_view only) {
  require_any(schema, only);
  return sim::list_keys_as_text(schema, 100, only);
}

std::string keys_as_json(const sim::Schema& schema, std::string_view only) {
  require_any(schema, only);
  Json keys = Json::array();
  for (const sim::Key& key : schema.keys()) {
    if (sim::is_or_is_below(key, only)) {
      keys.push_back(json_of_key(key));
    }
  }
  return keys.dump(2) + "\n";
}

}  // namespace marti::studies::show
