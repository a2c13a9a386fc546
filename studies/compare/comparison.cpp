#include "studies/compare/comparison.h"

#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/figures/counted_figures.h"
#include "studies/keys/setting_value.h"
#include "studies/sweep/plan/axis_text.h"
#include "studies/tables/json_table.h"

namespace marti::studies::compare {

namespace {

using Pair = std::pair<const sweep::StoredPoint*, const sweep::StoredPoint*>;

// A value with its type and all its digits, so that 1 and "1" differ.
std::string typed(const tables::Cell& cell) { return tables::json_text(tables::json_of(cell)); }

std::optional<std::size_t> axis_of(const Results& sweep, const std::string& axis) {
  const auto at = std::ranges::find(sweep.axes(), axis);
  return at == sweep.axes().end() ? std::nullopt
                                  : std::optional(static_cast<std::size_t>(at - sweep.axes().begin()));
}

// The axes by whose values the points of a sweep are told apart. What a named point gives (every value of
// "point" has one value of such an axis) may change from sweep to sweep.
std::vector<std::string> telling_axes(const Results& sweep) {
  const std::optional<std::size_t> named = axis_of(sweep, "point");
  std::vector<std::string> telling;
  for (std::size_t i = 0; i < sweep.axes().size(); ++i) {
    std::map<std::string, std::set<std::string>> values;
    for (const sweep::StoredPoint& point : sweep.points()) {
      values[named ? typed(point.values[*named]) : ""].insert(typed(point.values[i]));
    }
    const bool follows =
        std::ranges::all_of(values, [](const auto& value) { return value.second.size() == 1; });
    if (!named || i == *named || !follows) {
      telling.push_back(sweep.axes()[i]);
    }
  }
  return telling;
}

// The first point of each key, which is made of the values of `axes`, or of all settings.
std::map<std::string, const sweep::StoredPoint*> by_key(Results& sweep,
                                                        const std::vector<std::string>* axes) {
  std::map<std::string, const sweep::StoredPoint*> points;
  std::set<std::int64_t> machines;
  for (const sweep::StoredPoint& point : sweep.points()) {
    std::string key;
    if (axes != nullptr) {
      for (const std::string& axis : *axes) {
        key += axis + "=" + typed(point.values.at(*axis_of(sweep, axis)));
      }
    } else if (machines.insert(point.machine).second) {
      for (const auto& [name, value] : sweep.settings_of(point)) {
        key += name + "=" + value + "\n";
      }
    } else {
      continue;
    }
    points.emplace(std::move(key), &point);
  }
  return points;
}

std::vector<Pair> pairs_of_sweeps(Results& a, Results& b, Comparison& found) {
  // An axis that tells points apart in one of them is compared in both.
  std::vector<std::string> axes = telling_axes(a);
  std::ranges::copy_if(telling_axes(b), std::back_inserter(axes), [&axes](const std::string& axis) {
    return std::ranges::find(axes, axis) == axes.end();
  });
  const bool by_axes = std::ranges::all_of(
      axes, [&](const std::string& axis) { return axis_of(a, axis) && axis_of(b, axis); });
  found.join = by_axes ? Join::axes : Join::settings;
  const auto from = by_key(a, by_axes ? &axes : nullptr);
  auto to = by_key(b, by_axes ? &axes : nullptr);
  std::vector<Pair> pairs;
  for (const auto& [key, point] : from) {
    const auto other = to.find(key);
    if (other == to.end()) {
      found.a.alone.push_back(point->ordinal);
      continue;
    }
    ++found.both;
    if (point->done && other->second->done) {
      pairs.emplace_back(point, other->second);
    }
    to.erase(other);
  }
  for (const auto& [key, point] : to) {
    found.b.alone.push_back(point->ordinal);
  }
  std::ranges::sort(found.a.alone);
  std::ranges::sort(found.b.alone);
  return pairs;
}

std::vector<Pair> pairs_of(Results& a, Results& b, Comparison& found) {
  if (a.is_sweep() && b.is_sweep()) {
    return pairs_of_sweeps(a, b, found);
  }
  found.join = a.is_sweep() || b.is_sweep() ? Join::each : Join::one;
  std::vector<Pair> pairs;
  for (const sweep::StoredPoint& from : a.points()) {
    for (const sweep::StoredPoint& to : b.points()) {
      if (from.done && to.done) {
        pairs.emplace_back(&from, &to);
      }
    }
  }
  found.both = std::max(a.points().size(), b.points().size());
  if (pairs.empty()) {
    throw sim::UserError((a.is_sweep() ? a : b).name() +
                         ": no point of this sweep has been run yet; run the sweep again to finish it");
  }
  return pairs;
}

// Sets how far the settings of A and B are from each other.
void measure(JoinedPoint& point) {
  for (const Difference& setting : point.settings) {
    if (setting.is_one_sided()) {
      continue;
    }
    ++point.distance;
    const std::optional<double> a = setting_number(setting.name, setting.a);
    const std::optional<double> b = setting_number(setting.name, setting.b);
    if (a && b && *a > 0.0 && *b > 0.0) {
      point.doublings += std::abs(std::log2(*a / *b));
    }
  }
}

// "machine.nodes 8, cache.size 4 KiB": where a point of a sweep is.
std::string name_of(const std::vector<std::string>& axes, const std::vector<tables::Cell>& values) {
  std::string name;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    name += (i == 0 ? "" : ", ") + axes[i] + " " + sweep::axis_text(axes[i], values.at(i));
  }
  return name;
}

// Where a result would be, if it were one.
std::string own_values(const std::vector<std::string>& axes, const ComparedResult& result) {
  std::string name;
  for (const std::string& axis : axes) {
    if (const auto setting = result.settings.find(axis); setting != result.settings.end()) {
      name += (name.empty() ? "" : ", ") + axis + " " + keys::plain_setting(setting->second);
    }
  }
  return name;
}

// What is added up over the joined points.
struct Sums {
  std::map<std::string, FigureDifference> figures;
  std::set<std::string> settings;  // that both sides of a point have
  ActivityTimes times;
};

void enter_figures(std::vector<Difference> figures, const JoinedPoint& point, Comparison& found, Sums& sums) {
  std::erase_if(figures, [](const Difference& figure) { return figure.name.starts_with("frame."); });
  found.equal_points += figures.empty() ? 1 : 0;
  for (Difference& figure : figures) {
    FigureDifference& largest = sums.figures[figure.name];
    const auto size = [](const Difference& of) { return of.relative().value_or(2.0); };
    // The lowest point on ties, in whatever order points come.
    if (largest.points == 0 || size(figure) > size(largest) ||
        (size(figure) == size(largest) && point.a < largest.point_a)) {
      largest = {std::move(figure), point.a, point.b, largest.points};
    }
    ++largest.points;
  }
}

void join(const Pair& pair, const ComparedResult& a, const ComparedResult& b, Comparison& found, Sums& sums) {
  JoinedPoint& point = found.points.emplace_back();
  point.a = pair.first->ordinal;
  point.b = pair.second->ordinal;
  point.end_a = found.join == Join::one ? frame_time_if_any(a) : frame_time(a);
  point.end_b = found.join == Join::one ? frame_time_if_any(b) : frame_time(b);
  point.values = (found.sweep_is_a ? pair.first : pair.second)->values;
  point.name = name_of(found.axes, point.values);
  point.same_frame = same_frame(a, b);
  Differences differences = differences_of(a, b);
  point.settings = std::move(differences.settings);
  measure(point);
  for (const auto& [name, value] : a.settings) {
    if (b.settings.contains(name)) {
      sums.settings.insert(name);
    }
  }
  if (point.same_frame) {
    sums.times.add(a, b);
  }
  if (found.join != Join::one) {
    enter_figures(std::move(differences.figures), point, found, sums);
    return;
  }
  const auto with_points = [](const Difference& figure) { return FigureDifference{figure, 0, 0, 1}; };
  found.figures = sim::mapped(differences.figures, with_points);
  found.equal = sim::mapped(differences.equal, with_points);
  found.equal_figures = found.equal.size();
  found.a.helps = a.helps;
  found.b.helps = b.helps;
}

void sort_points(Comparison& found) {
  const auto distance = [&found](const JoinedPoint& point) {
    return std::tuple(point.distance, point.doublings, found.point(point));
  };
  const auto key = [&](const JoinedPoint& point) {
    const bool each = found.join == Join::each;
    const double size = each ? 0.0 : -std::abs(std::log(point.ratio()));
    return std::tuple_cat(
        std::tuple(!point.same_frame, each && point.same_frame ? found.end(point) : 0, size),
        each && !point.same_frame ? distance(point) : std::tuple(std::size_t{0}, 0.0, found.point(point)));
  };
  std::ranges::sort(found.points, {}, key);
  found.nearest =
      static_cast<std::size_t>(std::ranges::min_element(found.points, {}, distance) - found.points.begin());
  found.comparable =
      static_cast<std::size_t>(std::ranges::count(found.points, true, &JoinedPoint::same_frame));
}

// Finds the settings in which frames differ, and those in which all points differ alike.
void take_settings(std::set<std::string> equal, Comparison& found) {
  std::map<std::string, std::vector<const Difference*>> by_name;
  std::map<std::string, Difference> frame;
  for (const JoinedPoint& point : found.points) {
    for (const Difference& setting : point.settings) {
      by_name[setting.name].push_back(&setting);
      if (!point.same_frame && is_frame_setting(setting.name)) {
        frame.emplace(setting.name, setting);
      }
    }
  }
  for (auto& [name, setting] : frame) {
    found.frame.push_back(std::move(setting));
  }
  std::set<std::string> alike;
  for (const auto& [name, differences] : by_name) {
    const std::vector<const Difference*>& all = differences;  // Clang 14 cannot capture a binding
    equal.erase(name);
    if (all.size() == found.points.size() && std::ranges::all_of(all, [&](const Difference* other) {
          return other->a == all[0]->a && other->b == all[0]->b;
        })) {
      found.alike.push_back(*all[0]);
      alike.insert(name);
    }
  }
  found.varied_settings = by_name.size() - alike.size();
  found.equal_settings = equal.size();
  for (JoinedPoint& point : found.points) {
    std::erase_if(point.settings, [&](const Difference& setting) { return alike.contains(setting.name); });
  }
}

Side side_of(const Results& result) {
  Side side{result.name(), result.version()};
  side.planned = result.points().size();
  side.timed = static_cast<std::size_t>(std::ranges::count(result.points(), true, &sweep::StoredPoint::done));
  return side;
}

}  // namespace

Comparison compared(Results& a, Results& b) {
  Comparison found;
  found.a = side_of(a);
  found.b = side_of(b);
  found.sweep_is_a = a.is_sweep();
  found.noise = larger(a.noise(), b.noise());
  if (a.is_sweep() || b.is_sweep()) {
    found.axes = (a.is_sweep() ? a : b).axes();
  }
  const std::vector<Pair> pairs = pairs_of(a, b, found);
  if (a.has_store() || b.has_store()) {
    a.keep_what_sweeps_have(found.join == Join::one);
    b.keep_what_sweeps_have(found.join == Join::one);
  }
  Sums sums;
  for (const Pair& pair : pairs) {
    const ComparedResult& one = a.at(*pair.first, found.join == Join::one);
    const ComparedResult& other = b.at(*pair.second, found.join == Join::one);
    join(pair, one, other, found, sums);
    if (found.join == Join::each) {
      found.own_values = own_values(found.axes, found.sweep_is_a ? other : one);
    }
  }
  if (!pairs.empty()) {
    sort_points(found);
  }
  take_settings(std::move(sums.settings), found);
  found.times = sums.times.means();
  if (found.join != Join::one) {
    for (auto& [name, figure] : sums.figures) {
      found.figures.push_back(std::move(figure));
    }
    std::ranges::stable_sort(found.figures, std::greater(), rank);
    found.equal_figures = static_cast<std::size_t>(std::ranges::count_if(figures::counted_figures(),
                                                                         &figures::FigureEntry::of_machine)) -
                          found.figures.size();
  }
  return found;
}

}  // namespace marti::studies::compare
