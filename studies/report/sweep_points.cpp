#include "studies/report/sweep_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "processors/accounting.h"
#include "sim/error.h"
#include "sim/schema.h"
#include "studies/report/axis_order.h"
#include "studies/report/cycle_groups.h"
#include "studies/results/cell_number.h"
#include "studies/sweep/sweep_keys.h"
#include "studies/sweep/sweep_reader.h"

namespace marti::studies {

namespace {

// What a browser can be given as one page, and a person as one chart.
constexpr std::size_t most_points = 20'000;

constexpr std::string_view counters[] = {"end",
                                         "nodes",
                                         "clusters",
                                         "packets",
                                         "database_bytes",
                                         "events",
                                         "hits",
                                         "misses",
                                         "interconnect_reads",
                                         "interconnect_busy",
                                         "interconnect_links",
                                         "interconnect_bytes",
                                         "banks",
                                         "bank_busy",
                                         "speed_up",
                                         "efficiency",
                                         "times_faster",
                                         "hit_ratio",
                                         "l2_hit_ratio",
                                         "interconnect_utilisation",
                                         "bank_utilisation",
                                         "network_utilisation",
                                         "mean_interconnect_wait",
                                         "mean_bank_wait",
                                         "finish_balance"};

constexpr std::string_view kinds[] = {"node", "list", "primitive", "material"};
constexpr std::string_view waits[] = {"interconnect_wait", "bank_wait"};

std::vector<std::string> wanted_figures(const SweepReader& reader) {
  std::set<std::string, std::less<>> wanted(std::begin(counters), std::end(counters));
  for (const std::string_view activity : processors::activity_names) {
    wanted.insert("time_" + std::string(activity));
    wanted.insert("share_" + std::string(activity));
  }
  for (const std::string_view kind : kinds) {
    wanted.insert(std::string(kind) + "_hits");
    wanted.insert(std::string(kind) + "_misses");
  }
  // Those that a store of another version has not got are left out.
  std::vector<std::string> names = reader.figures();
  std::erase_if(names, [&](const std::string& name) { return !wanted.contains(name); });
  return names;
}

void add_hit_ratios(ReportPoint& point) {
  for (const std::string_view kind : kinds) {
    const double hits = point.figure(std::string(kind) + "_hits");
    const double all = hits + point.figure(std::string(kind) + "_misses");
    if (all > 0.0) {
      point.figures["hit_ratio_" + std::string(kind)] = hits / all;
    }
  }
}

void add_groups(ReportPoint& point) {
  const std::array<double, cycle_groups> parts =
      group_cycles([&](std::string_view activity) { return point.figure("share_" + std::string(activity)); });
  for (std::size_t i = 0; i < parts.size(); ++i) {
    point.figures["part_" + std::string(cycle_group_names[i])] = parts[i];
  }
}

// The upper bound of the bucket that the percentile lies in: waits are not above it.
void add_percentiles(const SweepRow& row, ReportPoint& point) {
  for (const SweepHistogram& histogram : row.histograms) {
    if (std::find(std::begin(waits), std::end(waits), histogram.what) == std::end(waits)) {
      continue;
    }
    double all = 0.0;
    for (const SweepHistogram::Bucket& bucket : histogram.buckets) {
      all += static_cast<double>(bucket.count);
    }
    for (const int percent : {50, 95, 99}) {
      double below = 0.0;
      for (const SweepHistogram::Bucket& bucket : histogram.buckets) {
        below += static_cast<double>(bucket.count);
        if (below >= all * percent / 100.0) {
          point.figures[fmt::format("{}_p{}", histogram.what, percent)] = static_cast<double>(bucket.highest);
          break;
        }
      }
    }
  }
}

// Settings that all machines of the sweep share, and what each says of its queues.
class Settings {
 public:
  explicit Settings(const SweepReader& reader) : reader_(reader) {}

  void add(ReportPoint& point) {
    const std::vector<std::pair<std::string, std::string>> settings = reader_.settings(point.machine);
    const std::map<std::string, std::string> by_key(settings.begin(), settings.end());
    const auto value = [&](const char* key) {
      const auto at = by_key.find(key);
      return at == by_key.end() ? std::string() : at->second;
    };
    const bool bus = value("interconnect.kind") == "\"bus\"";
    const bool local = value("database.placement") != "\"shared\"";
    point.links_are_queues = !local && (bus || value("interconnect.kind") == "\"crossbar\"");
    point.banks_are_queues = point.links_are_queues && !(bus && value("interconnect.mode") == "\"held\"");
    if (!begun_) {
      shared_ = by_key;
      begun_ = true;
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
  const SweepReader& reader_;
  std::map<std::string, std::string> shared_;
  bool begun_ = false;
};

// A value as its key would have it in a file.
std::string text_of(const Cell& cell, const sim::Key* key) {
  if (const auto* text = std::get_if<std::string>(&cell)) {
    return *text;
  }
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    if (key != nullptr && key->type == sim::ValueType::boolean) {
      return *integer != 0 ? "true" : "false";
    }
    const bool real =
        key != nullptr && (key->type == sim::ValueType::real || key->type == sim::ValueType::frequency ||
                           key->type == sim::ValueType::percentage);
    const sim::Value value = real ? sim::Value(static_cast<double>(*integer)) : sim::Value(*integer);
    std::string text = key == nullptr ? std::to_string(*integer) : sim::print_value(key->type, value);
    std::erase(text, '"');
    return text;
  }
  if (const auto* real = std::get_if<double>(&cell)) {
    const bool printable =
        key != nullptr && (key->type == sim::ValueType::real || key->type == sim::ValueType::frequency ||
                           key->type == sim::ValueType::percentage);
    std::string text = printable ? sim::print_value(key->type, sim::Value(*real)) : fmt::format("{}", *real);
    std::erase(text, '"');
    return text;
  }
  return "none";
}

std::string unit_of(const sim::Key* key) {
  if (key == nullptr) {
    return {};
  }
  switch (key->type) {
    case sim::ValueType::size:
      return "byte";
    case sim::ValueType::frequency:
      return "Hz";
    case sim::ValueType::duration:
      return "ps";
    default:
      return key->unit;
  }
}

bool is_boolean(const sim::Key* key) { return key != nullptr && key->type == sim::ValueType::boolean; }

ReportAxis make_axis(const AxisColumn& column, const sim::Schema& schema) {
  ReportAxis axis;
  axis.name = column.name;
  axis.followers = column.followers;
  axis.values = column.values;
  const std::optional<std::size_t> at = schema.find(column.name);
  const sim::Key* key = at ? &schema.keys()[*at] : nullptr;
  axis.unit = unit_of(key);
  axis.numeric =
      !is_boolean(key) && std::all_of(axis.values.begin(), axis.values.end(),
                                      [](const Cell& cell) { return number_of(cell).has_value(); });
  for (const Cell& value : axis.values) {
    axis.texts.push_back(text_of(value, key));
  }
  if (axis.numeric) {
    std::vector<double> numbers;
    for (const Cell& value : axis.values) {
      numbers.push_back(*number_of(value));
    }
    const std::size_t last = numbers.size() - 1;
    axis.logarithmic = numbers.front() > 0.0 &&
                       (last < 2 || numbers[last] - numbers[last - 1] > 1.5 * (numbers[1] - numbers[0]));
    axis.integer = std::all_of(axis.values.begin(), axis.values.end(),
                               [](const Cell& cell) { return std::holds_alternative<std::int64_t>(cell); });
  }
  return axis;
}

}  // namespace

double ReportAxis::number(std::size_t value) const { return number_of(values.at(value)).value_or(0.0); }

double ReportPoint::figure(std::string_view name) const {
  const auto at = figures.find(name);
  return at == figures.end() ? 0.0 : at->second;
}

std::optional<std::size_t> SweepPoints::axis(std::string_view name) const {
  const auto at =
      std::find_if(axes.begin(), axes.end(), [&](const ReportAxis& each) { return each.name == name; });
  return at == axes.end() ? std::nullopt : std::optional(static_cast<std::size_t>(at - axes.begin()));
}

SweepPoints read_sweep_points(const std::filesystem::path& store) {
  const SweepReader reader(store);
  SweepPoints sweep;
  sweep.version = reader.version();
  const std::vector<std::string> names = wanted_figures(reader);
  std::vector<std::vector<Cell>> values;
  Settings settings(reader);
  reader.for_each_point(names, [&](const StoredPoint& stored, std::span<const Cell> cells) {
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
      if (const std::optional<double> number = number_of(cells[i]); number && std::isfinite(*number)) {
        point.figures[names[i]] = *number;
      }
    }
    sweep.points.push_back(std::move(point));
    values.push_back(stored.values);
  });
  if (sweep.points.empty()) {
    throw sim::UserError(
        store.string() +
        ": no point of the sweep has been timed yet; run `marti sweep` with the same -o first");
  }
  for (ReportPoint& point : sweep.points) {
    add_hit_ratios(point);
    add_groups(point);
    if (const std::optional<SweepRow> row = reader.read_result(point.machine)) {
      add_percentiles(*row, point);
    }
    settings.add(point);
  }
  const sim::Schema schema = sweep_schema();
  for (const AxisColumn& column : order_axes(reader.axes(), values)) {
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      sweep.points[i].place.push_back(column.index[i]);
    }
    sweep.axes.push_back(make_axis(column, schema));
  }
  sweep.settings = settings.shared();
  sweep.priced = std::any_of(sweep.points.begin(), sweep.points.end(), [&](const ReportPoint& point) {
    return point.cost != sweep.points.front().cost;
  });
  for (ReportPoint& point : sweep.points) {
    point.figures["price"] = sweep.priced ? point.cost : point.figure("nodes");
  }
  sweep.provenance = {{"version of marti", sweep.version},
                      {"points", fmt::format("{} timed of {}", sweep.points.size(), sweep.planned)}};
  return sweep;
}

}  // namespace marti::studies
