#include "studies/sweep/plan/sweep_table.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "sim/config_errors.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "studies/sweep/plan/axis_values.h"

namespace marti::studies::sweep {

namespace {

using sim::DocumentEntry;
using sim::DocumentValue;

constexpr std::size_t longest_point_name = 60;

class TableReader {
 public:
  explicit TableReader(const sim::Config& config) : config_(config) {}

  SweepTable read(std::span<const std::string> arguments, std::span<const AxisArgument> more) {
    for (const std::string& argument : arguments) {
      add_argument(read_axis_argument(config_, argument), "--axis " + sim::shown(argument));
    }
    for (const AxisArgument& axis : more) {
      add_argument(axis, config_.name());
    }
    const DocumentValue::Table& sweep = config_.free_section("sweep");
    for (const DocumentEntry& entry : sweep) {
      read_part(entry);
    }
    if (table_.axes.empty()) {
      fail(std::max(1, config_.free_section_line("sweep")), "sweep",
           "there is nothing to sweep over: give lists of values in [sweep.axes], [[sweep.zip]] or "
           "[sweep.points.NAME], or --axis KEY=VALUE,VALUE,...");
    }
    std::ranges::stable_sort(table_.axes, [](const SweepAxis& a, const SweepAxis& b) {
      const bool first = a.kind == SweepAxis::Kind::named;
      return first != (b.kind == SweepAxis::Kind::named) ? first : a.line < b.line;
    });
    refuse_too_many();
    return std::move(table_);
  }

 private:
  using Visit = std::function<void(std::size_t key, const DocumentEntry& entry)>;

  [[noreturn]] void fail(int line, std::string_view key, const std::string& message) const {
    sim::fail_at(config_, line, key, message);
  }

  void add_argument(AxisArgument given, const std::string& where) {
    const std::string& name = config_.schema().names()[given.key];
    const sim::Place place{where, {}, 0, name};
    if (!sweepable(name)) {
      throw sim::UserError(place, std::string(not_sweepable));
    }
    if (!swept_.emplace(given.key, 0).second) {
      throw sim::UserError(place, "another --axis sweeps over this key");
    }
    if (config_.given_at(given.key) && config_.where(name).starts_with("--set")) {
      throw sim::UserError(place, "\"" + sim::shown(config_.where(name)) + "\" would have no effect");
    }
    SweepAxis axis{SweepAxis::Kind::list, 0, {given.key}, {}, {}};
    for (sim::Setting& step : given.steps) {
      axis.steps.push_back({std::move(step)});
    }
    table_.axes.push_back(std::move(axis));
  }

  // Whether an axis of the command line sweeps over the key.
  [[nodiscard]] bool replaced(std::size_t key) const {
    const auto found = swept_.find(key);
    return found != swept_.end() && found->second == 0;
  }

  void read_part(const DocumentEntry& entry) {
    const std::string name = "sweep." + entry.name;
    if (entry.name == "axes") {
      for_each_key(table_of(entry.value, name), name, "", [&](std::size_t key, const DocumentEntry& values) {
        if (replaced(key)) {
          return;
        }
        enter(key, values.line);
        SweepAxis axis{SweepAxis::Kind::list, values.line, {key}, {}, {}};
        for (sim::Setting& step : axis_values(config_, key, values.value, false)) {
          axis.steps.push_back({std::move(step)});
        }
        table_.axes.push_back(std::move(axis));
      });
    } else if (entry.name == "zip") {
      read_zips(entry);
    } else if (entry.name == "points") {
      read_points(table_of(entry.value, name), entry.line);
    } else if (entry.name == "base") {
      table_.base = assignments(entry.value, name);
      if (table_.base.empty()) {
        fail(entry.line, name, "gives nothing; leave it out to measure speed-up against one node");
      }
    } else if (entry.name == "compare") {
      table_.compare = assignments(entry.value, name);
    } else {
      const std::vector<std::string> parts = {"sweep.axes",        "sweep.zip",     "sweep.points",
                                              "sweep.base",        "sweep.compare", "sweep.filter",
                                              "sweep.skip_invalid"};
      const bool known =
          config_.schema().find(entry.name).has_value() || config_.schema().is_section(entry.name);
      fail(entry.line, name,
           "unknown key" +
               (known ? " (the keys of axes belong in [sweep.axes])" : sim::did_you_mean(name, parts)));
    }
  }

  const DocumentValue::Table& table_of(const DocumentValue& value, const std::string& name) const {
    if (value.table() == nullptr) {
      fail(value.line, name, "must be a table, not " + describe(value));
    }
    return *value.table();
  }

  // Visits the keys below a table, whose names are dotted, or quoted, or tables of tables.
  void for_each_key(const DocumentValue::Table& table, const std::string& part, const std::string& prefix,
                    const Visit& visit) const {
    const sim::Schema& schema = config_.schema();
    for (const DocumentEntry& entry : table) {
      const std::string name = prefix + entry.name;
      if (const std::optional<std::size_t> key = schema.find(name)) {
        refuse_unsweepable(name, entry.line);
        visit(*key, entry);
      } else if (const DocumentValue::Table* inner = entry.value.table();
                 inner != nullptr && schema.is_section(name)) {
        for_each_key(*inner, part, name + ".", visit);
      } else if (schema.is_section(name)) {
        fail(entry.line, name, "in [" + part + "] is a section and has no value of its own");
      } else {
        fail(entry.line, name,
             "unknown key in [" + part + "]" + sim::did_you_mean(name, schema.names()) +
                 "; `marti config` lists all keys");
      }
    }
  }

  static constexpr std::string_view not_sweepable =
      "says nothing about the simulated machine; a sweep cannot change it";

  static bool sweepable(std::string_view name) {
    constexpr std::array<std::string_view, 4> others = {"host_machine.", "record.", "prices.", "sweep."};
    return std::ranges::none_of(others, [&](std::string_view section) { return name.starts_with(section); });
  }

  void refuse_unsweepable(const std::string& name, int line) const {
    if (!sweepable(name)) {
      fail(line, name, std::string(not_sweepable));
    }
  }

  // Notes that the key is swept over, and refuses a key that already is.
  void enter(std::size_t key, int line) {
    const std::string& name = config_.schema().names()[key];
    const auto [place, fresh] = swept_.emplace(key, line);
    if (!fresh) {
      fail(line, name,
           place->second == 0
               ? "changes together with other keys here, so that --axis cannot replace its values"
               : "is swept over twice; the first time in line " + std::to_string(place->second));
    }
    if (config_.given_at(key) && config_.where(name).starts_with("--set")) {
      fail(line, name,
           "is swept over, so that \"" + sim::shown(config_.where(name)) + "\" would have no effect");
    }
  }

  void read_zips(const DocumentEntry& entry) {
    if (entry.value.table() != nullptr) {
      read_zip(*entry.value.table(), entry.line);
      return;
    }
    const DocumentValue::List* list = entry.value.list();
    if (list == nullptr) {
      fail(entry.line, "sweep.zip", "must be a table, as [[sweep.zip]], not " + describe(entry.value));
    }
    for (const DocumentValue& zip : *list) {
      read_zip(table_of(zip, "sweep.zip"), zip.line);
    }
  }

  void read_zip(const DocumentValue::Table& zip, int line) {
    SweepAxis axis{SweepAxis::Kind::zip, line, {}, {}, {}};
    for_each_key(zip, "sweep.zip", "", [&](std::size_t key, const DocumentEntry& values) {
      enter(key, values.line);
      std::vector<sim::Setting> steps = axis_values(config_, key, values.value, true);
      if (!axis.keys.empty() && steps.size() != axis.steps.size()) {
        const std::string& first = config_.schema().names()[axis.keys.front()];
        fail(values.line, config_.schema().names()[key],
             "has " + std::to_string(steps.size()) + " values, but " + first +
                 ", which changes with it, has " + std::to_string(axis.steps.size()));
      }
      axis.steps.resize(steps.size());
      for (std::size_t i = 0; i < steps.size(); ++i) {
        axis.steps[i].push_back(std::move(steps[i]));
      }
      axis.keys.push_back(key);
    });
    if (axis.keys.empty()) {
      fail(line, "sweep.zip", "names no keys");
    }
    table_.axes.push_back(std::move(axis));
  }

  void read_points(const DocumentValue::Table& points, int line) {
    SweepAxis axis{SweepAxis::Kind::named, line, {}, {}, {}};
    for (const DocumentEntry& point : points) {
      const std::string name = "sweep.points." + point.name;
      const bool plain = std::ranges::all_of(
          point.name, [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
      if (point.name.empty() || point.name.size() > longest_point_name || !plain) {
        fail(point.line, "sweep.points",
             "a point's name has 1 to " + std::to_string(longest_point_name) +
                 " printable ASCII characters without quotation marks and backslashes");
      }
      axis.names.push_back(point.name);
      axis.steps.push_back(assignments(point.value, name));
      for (const sim::Setting& setting : axis.steps.back()) {
        if (std::ranges::find(axis.keys, setting.key) == axis.keys.end()) {
          enter(setting.key, setting.line);
          axis.keys.push_back(setting.key);
        }
      }
    }
    if (axis.names.empty()) {
      fail(line, "sweep.points", "names no points, as [sweep.points.small] would");
    }
    table_.axes.push_back(std::move(axis));
  }

  // The single values of a table.
  std::vector<sim::Setting> assignments(const DocumentValue& value, const std::string& part) const {
    std::vector<sim::Setting> settings;
    for_each_key(table_of(value, part), part, "", [&](std::size_t key, const DocumentEntry& entry) {
      const auto same = [&](const sim::Setting& setting) { return setting.key == key; };
      if (std::ranges::any_of(settings, same)) {
        fail(entry.line, config_.schema().names()[key], "is given twice in [" + part + "]");
      }
      settings.push_back({key, config_.parse(key, entry.value), entry.line, {}});
    });
    return settings;
  }

  void refuse_too_many() const {
    std::uint64_t points = 1;
    for (const SweepAxis& axis : table_.axes) {
      points *= axis.steps.size();  // at most a million times a million
      if (points > most_sweep_points) {
        fail(axis.line, "sweep",
             (axis.line > 0 ? "the axes up to this line make " : "the axes given by --axis make ") +
                 std::to_string(points) + " points; a sweep has at most " +
                 std::to_string(most_sweep_points));
      }
    }
  }

  const sim::Config& config_;
  SweepTable table_;
  std::unordered_map<std::size_t, int> swept_;  // key and line; 0: by the command line
};

}  // namespace

SweepTable read_sweep_table(const sim::Config& config, std::span<const std::string> arguments,
                            std::span<const AxisArgument> more) {
  return TableReader(config).read(arguments, more);
}

}  // namespace marti::studies::sweep
