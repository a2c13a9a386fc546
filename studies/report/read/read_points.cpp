#include "studies/report/read/read_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/model/explorer.h"
#include "studies/report/model/sweep_answer.h"
#include "studies/sweep/plan/axis_text.h"
#include "studies/sweep/store/axis_order.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/cell_number.h"

namespace marti::studies::report {

namespace {

// What a browser can be given as one page, and a person as one chart.
constexpr std::size_t most_points = 20'000;
// Up to so many points come with all figures, so that a reader can look at any; of more only those that the
// page's own charts and tables need.
constexpr std::size_t most_points_with_all = 2'000;

std::vector<std::string> wanted_figures(const sweep::SweepReader& reader) {
  std::vector<std::string> names = reader.figures();
  if (reader.point_count() <= most_points_with_all) {
    return names;
  }
  const std::vector<std::string> first = first_figures();
  std::set<std::string, std::less<>> wanted(first.begin(), first.end());
  wanted.insert("nodes");  // what a machine costs if nothing has a price
  for (const DescribedChart& chart : described_charts("sweep")) {
    for (const nlohmann::ordered_json& field :
         chart.meta.at("live").value("fields", nlohmann::ordered_json::array())) {
      wanted.insert(field.get<std::string>());
    }
  }
  std::erase_if(names, [&](const std::string& name) { return !wanted.contains(name); });
  return names;
}

// Two values of a chart's axis may be the same number once they are shown with a chart's digits.
void check_axes(const std::filesystem::path& store, const ReportPoints& sweep) {
  for (const ReportAxis& axis : sweep.axes) {
    for (std::size_t value = 1; axis.numeric && value < axis.values.size(); ++value) {
      if (!(axis.number(value) > axis.number(value - 1))) {
        throw sim::UserError(
            fmt::format("{}: axis {} has two values that are the same number with the digits that a page can "
                        "show, {}; leave one of them out",
                        store.string(), axis.name, axis.texts[value]));
      }
    }
  }
}

// Numbers frames by what was rendered. A tree that was built otherwise gives the same rays and pixels: its
// machines can be compared.
class Frames {
 public:
  explicit Frames(const sweep::SweepReader& reader) : reader_(reader) {}

  [[nodiscard]] std::size_t number_of(std::int64_t machine) {
    std::string key;
    if (const std::optional<sweep::FrameRow> frame = reader_.read_frame(machine)) {
      key = fmt::format("{} {} {}", frame->scene_hash, frame->image_hash, frame->hit_hash);
    }
    return numbers_.emplace(key, numbers_.size()).first->second;
  }
  [[nodiscard]] std::size_t count() const { return numbers_.size(); }

 private:
  const sweep::SweepReader& reader_;
  std::map<std::string, std::size_t> numbers_;
};

// The settings that all machines of the sweep share.
class Settings {
 public:
  void add(const std::map<std::string, std::string>& by_key) {
    if (!std::exchange(begun_, true)) {
      shared_ = by_key;
      return;
    }
    std::erase_if(shared_, [&](const auto& setting) {
      const auto at = by_key.find(setting.first);
      return at == by_key.end() || at->second != setting.second;
    });
  }

  [[nodiscard]] std::vector<std::pair<std::string, std::string>> shared() const {
    return {shared_.begin(), shared_.end()};
  }

 private:
  std::map<std::string, std::string> shared_;
  bool begun_ = false;
};

ReportAxis make_axis(const sweep::AxisColumn& column) {
  ReportAxis axis;
  axis.name = column.name;
  axis.followers = column.followers;
  axis.values = column.values;
  axis.unit = sweep::axis_unit(column.name);
  axis.numeric =
      !sweep::is_boolean_axis(column.name) && std::ranges::all_of(axis.values, [](const tables::Cell& cell) {
        return tables::number_of(cell).has_value();
      });
  for (const tables::Cell& value : axis.values) {
    axis.texts.push_back(sweep::axis_text(column.name, value));
  }
  if (axis.numeric) {
    const std::vector<double> numbers =
        sim::mapped(axis.values, [&](const tables::Cell& value) { return *tables::number_of(value); });
    const std::size_t last = numbers.size() - 1;
    axis.logarithmic = numbers.front() > 0.0 &&
                       (last < 2 || numbers[last] - numbers[last - 1] > 1.5 * (numbers[1] - numbers[0]));
    axis.integer = std::ranges::all_of(
        axis.values, [](const tables::Cell& cell) { return std::holds_alternative<std::int64_t>(cell); });
  }
  return axis;
}

}  // namespace

ReportPoints read_report_points(const std::filesystem::path& store) {
  const sweep::SweepReader reader(store);
  ReportPoints sweep;
  sweep.version = reader.version();
  const std::vector<std::string> names = wanted_figures(reader);
  std::vector<std::vector<tables::Cell>> values;
  Settings settings;
  Frames frames(reader);
  reader.for_each_point(names, [&](const sweep::StoredPoint& stored, std::span<const tables::Cell> cells) {
    ++sweep.planned;
    if (!stored.done) {
      return;
    }
    if (sweep.points.size() == most_points) {
      throw sim::UserError(
          fmt::format("{}: has more than {} timed points, too many for one page; time a part of "
                      "them (sweep.filter) in a directory of its own, or read the store with "
                      "sqlite3",
                      store.string(), most_points));
    }
    ReportPoint point;
    point.ordinal = stored.ordinal;
    point.machine = stored.machine;
    point.cost = stored.cost;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (const std::optional<double> number = tables::number_of(cells[i])) {
        point.figures[names[i]] = *number;
      }
    }
    if (point.figure("end") <= 0.0) {
      throw sim::UserError(
          fmt::format("{}: point {}: the frame takes no time on this machine, so there is nothing to report; "
                      "leave the point out",
                      store.string(), stored.ordinal));
    }
    const std::vector<std::pair<std::string, std::string>> own = reader.settings(stored.machine);
    settings.add({own.begin(), own.end()});
    sweep.points.push_back(std::move(point));
    values.push_back(stored.values);
  });
  if (sweep.points.empty()) {
    throw sim::UserError(
        store.string() +
        ": no point of the sweep has been timed yet; run `marti sweep` with the same -o first");
  }
  for (ReportPoint& point : sweep.points) {
    point.frame = frames.number_of(point.machine);
  }
  sweep.frames = frames.count();
  sweep.answers = sweep::answers_of(reader);
  const std::vector<sweep::AxisColumn> columns = sweep::order_axes(reader.axes(), values);
  sweep.effects = sweep::axis_effects(
      columns, sim::mapped(sweep.points, [](const ReportPoint& point) { return point.figure("end"); }));
  sweep.effects.noise = reader.noise();
  for (const sweep::AxisColumn& column : columns) {
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      sweep.points[i].place.push_back(column.index[i]);
    }
    sweep.axes.push_back(make_axis(column));
  }
  check_axes(store, sweep);
  sweep.settings = settings.shared();
  sweep.priced = std::ranges::any_of(
      sweep.points, [&](const ReportPoint& point) { return point.cost != sweep.points.front().cost; });
  for (ReportPoint& point : sweep.points) {
    point.figures["price"] = sweep.priced ? point.cost : point.figure("nodes");
  }
  const std::map<std::int64_t, sweep::Advice> advice = reader.advice();
  for (ReportPoint& point : sweep.points) {
    if (const auto measured = advice.find(point.machine); measured != advice.end()) {
      point.advice = measured->second.sentence;
      point.noise = measured->second.noise;
    }
  }
  sweep.provenance = {{"version of marti", sweep.version},
                      {"points", fmt::format("{} timed of {}", sweep.points.size(), sweep.planned)}};
  return sweep;
}

}  // namespace marti::studies::report
