#include "studies/compare/compare_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

std::string time_of(const Cell& ticks) {
  const auto* whole = std::get_if<std::int64_t>(&ticks);
  return whole != nullptr ? seconds(*whole) : short_text(ticks, "-");
}

Json side_json(const ComparedResult& result) { return {{"name", result.name}, {"version", result.version}}; }

}  // namespace

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; },
      '?');
  return text;
}

std::string count(std::size_t number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

std::string lines_of(const std::vector<Difference>& differences, bool all) {
  const std::size_t shown = all ? differences.size() : std::min(differences.size(), most_lines);
  std::size_t name = 0;
  std::size_t a = 1;
  std::size_t b = 1;
  for (std::size_t i = 0; i < shown; ++i) {
    name = std::max(name, printable(differences[i].name).size());
    a = std::max(a, short_text(differences[i].a, "-").size());
    b = std::max(b, short_text(differences[i].b, "-").size());
  }
  std::string text;
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < shown; ++i) {
    const Difference& difference = differences[i];
    const std::string change = change_of(difference);
    fmt::format_to(out, "  {:<{}}  {:>{}}  {:>{}}", printable(difference.name), name,
                   printable(short_text(difference.a, "-")), a, printable(short_text(difference.b, "-")), b);
    text += change.empty() ? "\n" : fmt::format("  {:>12}\n", change);
  }
  if (shown < differences.size()) {
    fmt::format_to(out, "  and {} more: --all lists them\n", differences.size() - shown);
  }
  return text;
}

std::string differences_text(const ComparedResult& a, const ComparedResult& b, const Differences& found,
                             bool all) {
  std::string text = fmt::format("A  {}\nB  {}\n", printable(a.name), printable(b.name));
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\nconfiguration  {} differ{}, {} equal\n", count(found.settings.size(), "setting"),
                 found.settings.size() == 1 ? "s" : "", found.equal_settings);
  // What differs in the configuration is never cut off.
  text += lines_of(found.settings, true);
  const std::size_t differ = found.numbers.size() + found.texts.size();
  fmt::format_to(out, "\nresults        {} differ{}, {} equal\n", count(differ, "figure"),
                 differ == 1 ? "s" : "", found.equal.size());
  // The frame time comes first, whatever its place in the order.
  for (const Difference& difference : found.numbers) {
    if (difference.name == "end") {
      fmt::format_to(out, "frame time     {} in A, {} in B: {}\n", time_of(difference.a),
                     time_of(difference.b), change_of(difference));
    }
  }
  text += lines_of(found.texts, true);
  text += lines_of(found.numbers, all);
  if (!found.one_side.empty()) {
    fmt::format_to(out, "\nof one only    {}\n", count(found.one_side.size(), "figure"));
    text += lines_of(found.one_side, all);
  }
  if (all && !found.equal.empty()) {
    fmt::format_to(out, "\nequal          {}\n", count(found.equal.size(), "figure"));
    text += lines_of(found.equal, true);
  }
  return text;
}

nlohmann::ordered_json json_of(const Difference& difference) {
  Json object = {{"name", difference.name}, {"a", json_of(difference.a)}, {"b", json_of(difference.b)}};
  if (const std::optional<double> relative = difference.relative()) {
    object["relative"] = *relative;
  }
  return object;
}

nlohmann::ordered_json json_of(const std::vector<Difference>& differences) {
  Json list = Json::array();
  for (const Difference& difference : differences) {
    list.push_back(json_of(difference));
  }
  return list;
}

std::string differences_json(const ComparedResult& a, const ComparedResult& b, const Differences& found,
                             bool all) {
  Json object = {{"a", side_json(a)},
                 {"b", side_json(b)},
                 {"settings", json_of(found.settings)},
                 {"equal_settings", found.equal_settings},
                 {"texts", json_of(found.texts)},
                 {"numbers", json_of(found.numbers)},
                 {"one_side", json_of(found.one_side)},
                 {"equal_figures", found.equal.size()}};
  if (all) {
    object["equal"] = json_of(found.equal);
  }
  return json_text(object);
}

}  // namespace marti::studies
