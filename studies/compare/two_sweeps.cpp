#include "studies/compare/two_sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "studies/compare/compare_text.h"
#include "studies/compare/differences.h"
#include "studies/compare/figures.h"
#include "studies/keys/setting_value.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

struct Sweep {
  explicit Sweep(const std::filesystem::path& file) : reader(file), points(reader.points()) {}

  sweep::SweepReader reader;
  std::vector<sweep::StoredPoint> points;
};

// A value with its type and all its digits, so that 1 and "1" differ.
std::string typed(const tables::Cell& cell) {
  const auto* const text = std::get_if<std::string>(&cell);
  const auto* const integer = std::get_if<std::int64_t>(&cell);
  const std::string value = text != nullptr      ? *text
                            : integer != nullptr ? std::to_string(*integer)
                                                 : fmt::format("{}", tables::number_of(cell).value_or(0.0));
  return fmt::format("{}:{}", cell.index(), value);
}

std::map<std::string, std::string> settings_of(const sweep::SweepReader& reader, std::int64_t machine) {
  const auto list = reader.settings(machine);
  return {list.begin(), list.end()};
}

// The axes by whose values the points of a sweep are told apart. What a named point gives (every value of
// "point" has one value of such an axis) may change from sweep to sweep.
std::vector<std::string> telling_axes(const Sweep& sweep) {
  const std::vector<std::string>& axes = sweep.reader.axes();
  const auto named = std::ranges::find(axes, "point");
  if (named == axes.end()) {
    return axes;
  }
  const auto at = static_cast<std::size_t>(named - axes.begin());
  std::vector<std::string> telling = {"point"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    std::map<std::string, std::set<std::string>> values;
    for (const sweep::StoredPoint& point : sweep.points) {
      values[typed(point.values[at])].insert(typed(point.values[i]));
    }
    const bool follows =
        std::ranges::all_of(values, [](const auto& value) { return value.second.size() == 1; });
    if (i != at && !follows) {
      telling.push_back(axes[i]);
    }
  }
  return telling;
}

std::string axes_key(const Sweep& sweep, const sweep::StoredPoint& point,
                     const std::vector<std::string>& axes) {
  std::string key;
  for (const std::string& axis : axes) {
    const auto at = std::ranges::find(sweep.reader.axes(), axis);
    const tables::Cell& value = point.values.at(static_cast<std::size_t>(at - sweep.reader.axes().begin()));
    key += axis + "=" + typed(value) + "\n";
  }
  return key;
}

std::string settings_key(const Sweep& sweep, const sweep::StoredPoint& point) {
  std::string key;
  for (const auto& [name, value] : sweep.reader.settings(point.machine)) {
    key += name;
    key += '=';
    key += value;
    key += '\n';
  }
  return key;
}

// The first point of each key.
using Index = std::map<std::string, const sweep::StoredPoint*>;

Index index_of(const Sweep& sweep, const std::vector<std::string>* axes) {
  Index index;
  std::set<std::int64_t> machines;
  for (const sweep::StoredPoint& point : sweep.points) {
    if (axes != nullptr) {
      index.emplace(axes_key(sweep, point, *axes), &point);
    } else if (machines.insert(point.machine).second) {
      index.emplace(settings_key(sweep, point), &point);
    }
  }
  return index;
}

ComparedResult result_of(const Sweep& sweep, const sweep::StoredPoint& point) {
  ComparedResult result;
  result.name = fmt::format("{}:{}", sweep.reader.file().string(), point.ordinal);
  result.version = sweep.reader.version();
  result.settings = settings_of(sweep.reader, point.machine);
  add_counters(*sweep.reader.read_result(point.machine), result.figures);
  return result;
}

// The values of a point's axes as people write them.
std::vector<std::string> texts_of(const Sweep& sweep, const sweep::StoredPoint& point,
                                  const std::map<std::string, std::string>& settings) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < sweep.reader.axes().size(); ++i) {
    const auto setting = settings.find(sweep.reader.axes()[i]);
    texts.push_back(printable(setting == settings.end() ? tables::short_text(point.values[i], "-")
                                                        : keys::plain_setting(setting->second)));
  }
  return texts;
}

std::string name_of(const std::vector<std::string>& axes, const std::vector<std::string>& texts) {
  std::string name;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    name += (name.empty() ? "" : ", ") + printable(axes[i]) + " " + texts[i];
  }
  return name;
}

void enter_counters(const Differences& differences, const JoinedPoint& point,
                    std::map<std::string, CounterDifference>& counters) {
  const auto enter = [&](const Difference& difference) {
    CounterDifference& counter = counters[difference.name];
    ++counter.points;
    constexpr double one_sided = 2.0;
    const double size = difference.relative().value_or(one_sided);
    const double largest = counter.largest.relative().value_or(one_sided);
    // The lowest point on ties, in whatever order points come.
    if (counter.points == 1 || size > largest || (size == largest && point.a < counter.a)) {
      counter.largest = difference;
      counter.a = point.a;
      counter.b = point.b;
    }
  };
  std::ranges::for_each(differences.numbers, enter);
  std::ranges::for_each(differences.one_side, enter);
}

// Sums over the joined points.
struct Sums {
  std::map<std::string, CounterDifference> counters;
  std::map<std::string, double> times;  // changes by A's frame time
  std::size_t timed = 0;                // points that have the times
};

void enter_times(const ComparedResult& one, const ComparedResult& other, Sums& sums) {
  const std::vector<ActivityTime> times = activity_times(one, other);
  const auto end = static_cast<double>(frame_time(one));
  for (const ActivityTime& time : times) {
    sums.times[time.activity] += time.change / end;
  }
  sums.timed += times.empty() ? 0 : 1;
}

std::vector<MeanChange> mean_changes(const Sums& sums) {
  std::vector<MeanChange> means;
  for (const auto& [activity, sum] : sums.times) {
    means.push_back({activity, sum / static_cast<double>(sums.timed)});
  }
  std::ranges::stable_sort(means, [](const MeanChange& x, const MeanChange& y) {
    return std::abs(x.of_frame) > std::abs(y.of_frame);
  });
  return means;
}

// One pair of timed points.
void join(const Sweep& a, const Sweep& b, const sweep::StoredPoint& from, const sweep::StoredPoint& to,
          TwoSweeps& found, Sums& sums) {
  ComparedResult one = result_of(a, from);
  ComparedResult other = result_of(b, to);
  JoinedPoint point;
  point.a = from.ordinal;
  point.b = to.ordinal;
  point.texts = texts_of(a, from, one.settings);
  point.name = name_of(found.axes, point.texts);
  point.values = from.values;
  point.end_a = frame_time(one);
  point.end_b = frame_time(other);
  const Differences differences = differences_of(one, other);
  found.equal += differences.numbers.empty() && differences.one_side.empty() ? 1 : 0;
  enter_counters(differences, point, sums.counters);
  keep_what_sweeps_have(one);
  keep_what_sweeps_have(other);
  point.settings = differences_of(one, other).settings;
  for (auto [sweep, stored, result] : {std::tuple(&a, &from, &one), std::tuple(&b, &to, &other)}) {
    if (const std::optional<sweep::FrameRow> frame = sweep->reader.read_frame(stored->machine)) {
      add_frame(*frame, *result);
    }
  }
  point.same_frame = same_frame(one, other);
  if (point.same_frame) {
    enter_times(one, other, sums);
  }
  found.points.push_back(std::move(point));
}

double size_of(const JoinedPoint& point) { return std::abs(std::log(point.ratio())); }

void sort_points(TwoSweeps& found) {
  std::ranges::stable_sort(found.points, [](const JoinedPoint& x, const JoinedPoint& y) {
    if (x.same_frame != y.same_frame) {
      return x.same_frame;
    }
    return size_of(x) != size_of(y) ? size_of(x) > size_of(y) : x.a < y.a;
  });
}

void take_settings(TwoSweeps& found) {
  std::map<std::string, Difference> frame;
  std::vector<std::vector<Difference>*> lists;
  for (JoinedPoint& point : found.points) {
    if (!point.same_frame) {
      for (const Difference& setting : frame_settings(point.settings)) {
        frame.emplace(setting.name, setting);
      }
    }
    lists.push_back(&point.settings);
  }
  for (auto& [name, setting] : frame) {
    found.frame.push_back(std::move(setting));
  }
  found.alike = take_alike(lists).alike;
}

}  // namespace

std::size_t TwoSweeps::comparable() const {
  return static_cast<std::size_t>(std::ranges::count(points, true, &JoinedPoint::same_frame));
}

TwoSweeps two_sweeps(const std::filesystem::path& file_a, const std::filesystem::path& file_b) {
  const Sweep a(file_a);
  const Sweep b(file_b);
  TwoSweeps found;
  found.a = file_a.string();
  found.b = file_b.string();
  found.version_a = a.reader.version();
  found.version_b = b.reader.version();
  found.axes = a.reader.axes();
  // An axis that tells points apart in one of them is compared in both.
  std::vector<std::string> axes = telling_axes(a);
  for (const std::string& axis : telling_axes(b)) {
    if (std::ranges::find(axes, axis) == axes.end()) {
      axes.push_back(axis);
    }
  }
  const auto has = [](const Sweep& sweep, const std::string& axis) {
    const std::vector<std::string>& there = sweep.reader.axes();
    return std::ranges::find(there, axis) != there.end();
  };
  found.by_axes =
      std::ranges::all_of(axes, [&](const std::string& axis) { return has(a, axis) && has(b, axis); });
  const Index from = index_of(a, found.by_axes ? &axes : nullptr);
  const Index to = index_of(b, found.by_axes ? &axes : nullptr);
  Sums sums;
  for (const auto& [key, point] : from) {
    const auto other = to.find(key);
    if (other == to.end()) {
      found.only_a.push_back(point->ordinal);
      continue;
    }
    ++found.both;
    if (point->done && other->second->done) {
      join(a, b, *point, *other->second, found, sums);
    }
  }
  for (const auto& [key, point] : to) {
    if (!from.contains(key)) {
      found.only_b.push_back(point->ordinal);
    }
  }
  std::ranges::sort(found.only_a);
  std::ranges::sort(found.only_b);
  sort_points(found);
  take_settings(found);
  found.counters = static_cast<std::size_t>(
      std::ranges::count_if(figures::counted_figures(), &figures::FigureEntry::of_machine));
  found.times = mean_changes(sums);
  for (auto& [name, counter] : sums.counters) {
    found.differing.push_back(std::move(counter));
  }
  std::ranges::stable_sort(found.differing, [](const auto& x, const auto& y) {
    return x.largest.relative().value_or(2.0) > y.largest.relative().value_or(2.0);
  });
  return found;
}

std::optional<double> mean_ratio(const TwoSweeps& found) {
  double sum = 0.0;
  const std::size_t comparable = found.comparable();
  for (std::size_t i = 0; i < comparable; ++i) {
    sum += std::log(found.points[i].ratio());
  }
  return comparable == 0 ? std::nullopt : std::optional(std::exp(sum / static_cast<double>(comparable)));
}

}  // namespace marti::studies::compare
