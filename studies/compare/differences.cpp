#include "studies/compare/differences.h"

#include <algorithm>
#include <cmath>

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

}  // namespace marti::studies::compare
