#include "studies/compare/differences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string>

#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

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

// As Differences::numbers is sorted.
void sort_by_size(std::vector<Difference>& numbers) {
  std::ranges::stable_sort(numbers, [](const Difference& a, const Difference& b) {
    const double first = a.relative().value_or(0.0);
    const double second = b.relative().value_or(0.0);
    return first != second ? first > second : a.name < b.name;
  });
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
    if (from != nullptr && to != nullptr && *from == *to) {
      ++found.equal_settings;
    } else {
      found.settings.push_back({key, from == nullptr ? tables::Cell() : tables::Cell(*from),
                                to == nullptr ? tables::Cell() : tables::Cell(*to)});
    }
  });
  merge(a.figures, b.figures, [&](const std::string& name, const tables::Cell* from, const tables::Cell* to) {
    Difference difference{name, from == nullptr ? tables::Cell() : *from,
                          to == nullptr ? tables::Cell() : *to};
    if (from == nullptr || to == nullptr) {
      found.one_side.push_back(std::move(difference));
    } else if (*from == *to) {
      found.equal.push_back(std::move(difference));
    } else if (difference.relative()) {
      // 2 and 2.0 are the same number.
      (tables::number_of(*from) == tables::number_of(*to) && from->index() != to->index() ? found.equal
                                                                                          : found.numbers)
          .push_back(std::move(difference));
    } else {
      found.texts.push_back(std::move(difference));
    }
  });
  sort_by_size(found.numbers);
  return found;
}

SharedDifferences take_alike(std::span<std::vector<Difference>* const> lists) {
  std::map<std::string, std::vector<const Difference*>> by_name;
  for (const std::vector<Difference>* list : lists) {
    for (const Difference& difference : *list) {
      by_name[difference.name].push_back(&difference);
    }
  }
  SharedDifferences found;
  for (const auto& [name, differences] : by_name) {
    const Difference& first = *differences.front();
    const bool alike = differences.size() == lists.size() &&
                       std::ranges::all_of(differences, [&first](const Difference* other) {
                         return other->a == first.a && other->b == first.b;
                       });
    const auto both = std::ranges::find_if(differences, [](const Difference* difference) {
      return difference->a != tables::Cell() && difference->b != tables::Cell();
    });
    (alike ? found.alike : found.varied).push_back(both == differences.end() ? first : **both);
  }
  for (std::vector<Difference>* list : lists) {
    std::erase_if(*list, [&found](const Difference& difference) {
      return std::ranges::any_of(found.alike,
                                 [&](const Difference& alike) { return alike.name == difference.name; });
    });
  }
  return found;
}

namespace {

bool has_hashes(const ComparedResult& result) {
  return result.figures.contains("frame.image_hash") && result.figures.contains("frame.hit_hash");
}

// The settings of the frame, in order.
std::vector<std::pair<std::string, std::string>> settings_of_frame(const ComparedResult& result) {
  std::vector<std::pair<std::string, std::string>> settings;
  std::ranges::copy_if(result.settings, std::back_inserter(settings),
                       [](const auto& setting) { return is_frame_setting(setting.first); });
  return settings;
}

}  // namespace

bool is_frame_setting(std::string_view key) {
  constexpr std::array<std::string_view, 4> sections = {"scene", "frames", "image", "structure"};
  return std::ranges::find(sections, key.substr(0, key.find('.'))) != sections.end();
}

bool same_frame(const ComparedResult& a, const ComparedResult& b) {
  if (!has_hashes(a) || !has_hashes(b)) {
    return settings_of_frame(a) == settings_of_frame(b);
  }
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

std::vector<Difference> frame_settings(const std::vector<Difference>& settings) {
  std::vector<Difference> found;
  std::ranges::copy_if(settings, std::back_inserter(found),
                       [](const Difference& setting) { return is_frame_setting(setting.name); });
  return found;
}

}  // namespace marti::studies::compare
