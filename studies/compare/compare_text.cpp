#include "studies/compare/compare_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sim/mapped.h"
#include "studies/compare/verdict.h"
#include "studies/keys/setting_value.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

using Json = nlohmann::ordered_json;

// The value of a setting as JSON has it; null where the machine does not use the setting.
Json typed(const std::string& key, const tables::Cell& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr ? Json() : keys::setting_value(key, *text);
}

Json side_json(const ComparedResult& result) { return {{"name", result.name}, {"version", result.version}}; }

// Figures with their units, the first `shown` of them.
std::string figure_lines(const std::vector<Difference>& figures, bool all) {
  const std::size_t shown = all ? figures.size() : std::min(figures.size(), most_lines);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < shown; ++i) {
    const Difference& figure = figures[i];
    const std::string unit = unit_of_figure(figure.name);
    rows.push_back({printable(figure.name), printable(tables::figure_text(figure.a, unit, "-")),
                    printable(tables::figure_text(figure.b, unit, "-")), change_of(figure)});
  }
  return tables::aligned(rows, {true}) + and_more(shown, figures.size());
}

std::string time_lines(const ComparedPair& pair) {
  std::vector<std::vector<std::string>> rows = {{"mean of a node", "A", "B", "change", "of A's frame"}};
  const auto end = static_cast<double>(frame_time(pair.a));
  for (const ActivityTime& time : pair.times) {
    rows.push_back({time.activity, tables::seconds(time.mean_a), tables::seconds(time.mean_b),
                    tables::signed_seconds(std::llround(time.change)),
                    tables::signed_percent(time.change / end)});
  }
  return tables::aligned(rows, {true});
}

Json times_json(const std::vector<ActivityTime>& times) {
  return sim::mapped(times, [&](const ActivityTime& time) {
    return Json{{"name", "time_" + time.activity},
                {"a", tables::json_of(time.a)},
                {"b", tables::json_of(time.b)},
                {"change_a_node", time.change}};
  });
}

}  // namespace

std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return text;
}

std::string differ(std::size_t number, std::string_view what) {
  return tables::counted(number, what) + (number == 1 ? " differs" : " differ");
}

std::string setting_text(const tables::Cell& value) {
  const auto* text = std::get_if<std::string>(&value);
  return printable(text == nullptr ? tables::short_text(value, "-") : keys::plain_setting(*text));
}

std::optional<double> setting_number(const std::string& key, const tables::Cell& value) {
  const Json json = typed(key, value);
  return json.is_number() && std::isfinite(json.get<double>()) ? std::optional(json.get<double>())
                                                               : std::nullopt;
}

std::string values_text(const std::vector<Difference>& settings, tables::Cell Difference::*side, bool all) {
  std::string text;
  for (const Difference& setting : settings) {
    if (all || (setting.a != tables::Cell() && setting.b != tables::Cell())) {
      text += (text.empty() ? "" : ", ") + printable(setting.name) + " " + setting_text(setting.*side);
    }
  }
  return text.empty() ? "-" : text;
}

std::string and_more(std::size_t shown, std::size_t of) {
  return shown < of ? fmt::format("  and {} more: --all lists them\n",
                                  tables::grouped(static_cast<std::int64_t>(of - shown)))
                    : std::string();
}

std::string verdict_lines(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) {
    text += fmt::format("{:<15}{}\n", text.empty() ? "verdict" : "", printable(sentence));
  }
  return text;
}

std::string settings_lines(const std::vector<Difference>& settings) {
  const std::vector<std::vector<std::string>> rows = sim::mapped(settings, [&](const Difference& setting) {
    return std::vector<std::string>{printable(setting.name), setting_text(setting.a),
                                    setting_text(setting.b)};
  });
  return tables::aligned(rows, {true});
}

std::string differences_text(const ComparedPair& pair, bool all) {
  const Differences& found = pair.differences;
  std::string text = fmt::format("A  {}\nB  {}\n\n", printable(pair.a.name), printable(pair.b.name));
  const auto out = std::back_inserter(text);
  text += verdict_lines(verdict_of(pair));
  for (const std::string& sentence : helps_of(pair)) {
    fmt::format_to(out, "{:<15}{}\n", "", printable(sentence));
  }
  fmt::format_to(out, "\nconfiguration  {}, {} equal\n", differ(found.settings.size(), "setting"),
                 found.equal_settings);
  // What differs in the configuration is never cut off.
  text += settings_lines(found.settings);
  if (!pair.times.empty() && !found.numbers.empty()) {
    fmt::format_to(out, "\nwhere the time went\n{}", time_lines(pair));
  }
  fmt::format_to(out, "\nresults        {}, {} equal\n",
                 differ(found.numbers.size() + found.texts.size(), "figure"), found.equal.size());
  text += figure_lines(found.texts, true);
  text += figure_lines(found.numbers, all);
  if (!found.one_side.empty()) {
    fmt::format_to(out, "\nof one only    {}\n", tables::counted(found.one_side.size(), "figure"));
    text += figure_lines(found.one_side, all);
  }
  if (all && !found.equal.empty()) {
    fmt::format_to(out, "\nequal          {}\n", tables::counted(found.equal.size(), "figure"));
    text += figure_lines(found.equal, true);
  }
  return text;
}

nlohmann::ordered_json json_of(const Difference& figure) {
  Json object = {{"name", figure.name}, {"a", tables::json_of(figure.a)}, {"b", tables::json_of(figure.b)}};
  if (const std::string unit = unit_of_figure(figure.name); !unit.empty()) {
    object["unit"] = unit;
  }
  if (const std::optional<double> relative = figure.relative()) {
    object["relative"] = *relative;
  }
  return object;
}

nlohmann::ordered_json json_of(const std::vector<Difference>& figures) {
  return sim::mapped(figures, [&](const Difference& figure) { return json_of(figure); });
}

nlohmann::ordered_json settings_json(const std::vector<Difference>& settings) {
  return sim::mapped(settings, [&](const Difference& setting) {
    return Json{
        {"name", setting.name}, {"a", typed(setting.name, setting.a)}, {"b", typed(setting.name, setting.b)}};
  });
}

std::string differences_json(const ComparedPair& pair, bool all) {
  const Differences& found = pair.differences;
  Json object = {{"a", side_json(pair.a)},
                 {"b", side_json(pair.b)},
                 {"verdict", verdict_of(pair)},
                 {"what_helps", helps_of(pair)},
                 {"same_frame", pair.same_frame},
                 {"settings", settings_json(found.settings)},
                 {"equal_settings", found.equal_settings},
                 {"times", times_json(pair.times)},
                 {"texts", json_of(found.texts)},
                 {"numbers", json_of(found.numbers)},
                 {"one_side", json_of(found.one_side)},
                 {"equal_figures", found.equal.size()}};
  if (all) {
    object["equal"] = json_of(found.equal);
  }
  return tables::json_text(object);
}

}  // namespace marti::studies::compare
