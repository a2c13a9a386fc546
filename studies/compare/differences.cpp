#include "studies/compare/differences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "studies/keys/setting_value.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

using Json = nlohmann::ordered_json;

// Calls visit(name, value of a or null, value of b or null) for each name of either, in order.
template <class Map, class Visit>
void merge(const Map& a, const Map& b, const Visit& visit) {
  auto at_a = a.begin();
  auto at_b = b.begin();
  while (at_a != a.end() || at_b != b.end()) {
    if (at_b == b.end() || (at_a != a.end() && at_a->first < at_b->first)) {
      visit(at_a->first, &at_a->second, nullptr);
      ++at_a;
    } else if (at_a == a.end() || at_b->first < at_a->first) {
      visit(at_b->first, nullptr, &at_b->second);
      ++at_b;
    } else {
      visit(at_a->first, &at_a->second, &at_b->second);
      ++at_a;
      ++at_b;
    }
  }
}

}  // namespace

std::optional<double> Difference::relative() const {
  const std::optional<double> from = tables::number_of(a);
  const std::optional<double> to = tables::number_of(b);
  if (!from || !to) {
    return std::nullopt;
  }
  const double largest = std::max(std::abs(*from), std::abs(*to));
  return largest > 0.0 ? std::abs(*to - *from) / largest : 0.0;
}

double rank(const Difference& figure) {
  constexpr double of_text = 3.0;  // more than of any number
  return figure.is_one_sided() ? -1.0 : figure.relative().value_or(of_text);
}

std::string change_of(const Difference& difference) {
  const std::optional<double> from = tables::number_of(difference.a);
  const std::optional<double> to = tables::number_of(difference.b);
  if (!from || !to) {
    return "";
  }
  if (*from == 0.0) {
    return *to == 0.0 ? "" : "from 0";
  }
  const double change = (*to - *from) / std::abs(*from);
  return *from > 0.0 ? tables::change_percent(change) : tables::signed_percent(change);
}

Differences differences_of(const ComparedResult& a, const ComparedResult& b) {
  Differences found;
  if (a.version != b.version) {
    found.settings.push_back({"version of the program", a.version, b.version});
  }
  merge(a.settings, b.settings, [&](const std::string& key, const std::string* from, const std::string* to) {
    if (from == nullptr || to == nullptr || *from != *to) {
      found.settings.push_back({key, from == nullptr ? tables::Cell() : tables::Cell(*from),
                                to == nullptr ? tables::Cell() : tables::Cell(*to)});
    }
  });
  merge(a.figures, b.figures, [&](const std::string& name, const tables::Cell* from, const tables::Cell* to) {
    Difference difference{name, from == nullptr ? tables::Cell() : *from,
                          to == nullptr ? tables::Cell() : *to};
    // 2 and 2.0 are the same number.
    const bool equal = difference.a == difference.b ||
                       (difference.a.index() != difference.b.index() && difference.relative() == 0.0);
    (equal ? found.equal : found.figures).push_back(std::move(difference));
  });
  std::ranges::stable_sort(found.figures, std::greater(), rank);
  return found;
}

std::string setting_text(const tables::Cell& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr ? tables::short_text(value, "-") : keys::plain_setting(*text);
}

std::optional<double> setting_number(const std::string& key, const tables::Cell& value) {
  const auto* text = std::get_if<std::string>(&value);
  const Json json = text == nullptr ? Json() : keys::setting_value(key, *text);
  return json.is_number() && std::isfinite(json.get<double>()) ? std::optional(json.get<double>())
                                                               : std::nullopt;
}

bool is_frame_setting(std::string_view key) {
  constexpr std::array<std::string_view, 4> sections = {"scene", "frames", "image", "structure"};
  return std::ranges::find(sections, key.substr(0, key.find('.'))) != sections.end();
}

bool same_frame(const ComparedResult& a, const ComparedResult& b) {
  constexpr std::array<const char*, 4> identity = {"frame.image_hash", "frame.hit_hash", "frame.width",
                                                   "frame.height"};
  const auto value = [](const ComparedResult& result, const char* name) {
    const auto at = result.figures.find(name);
    return at == result.figures.end() ? tables::Cell() : at->second;
  };
  // Images and hits of two scenes can be equal where they differ in what no ray meets.
  return (a.scene_hash.empty() || b.scene_hash.empty() || a.scene_hash == b.scene_hash) &&
         std::ranges::all_of(identity, [&](const char* name) { return value(a, name) == value(b, name); });
}

}  // namespace marti::studies::compare
