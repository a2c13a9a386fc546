#include "studies/sweep/plan/sweep_plan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "sim/config_errors.h"
#include "sim/shown.h"
#include "studies/keys/price_keys.h"
#include "studies/sweep/plan/machine_list.h"
#include "studies/sweep/plan/read_point.h"
#include "studies/sweep/plan/sweep_filter.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_points.h"
#include "studies/sweep/plan/sweep_table.h"

namespace marti::studies::sweep {

namespace {

// Points read at a time: enough for all host cores, and few enough to stay in their caches until equal
// machines have become one.
constexpr std::size_t points_at_once = 256;

// Values as a user reads them: quantities without the quotation marks of TOML.
std::string plain_values(const sim::Key& key, const std::vector<sim::Value>& values) {
  std::string text = print_values(key, values);
  const bool quoted = !key.is_list && key.type != sim::ValueType::text && text.front() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

// The frame and the machine of a point, or why they cannot be had.
struct Outcome {
  std::optional<ReadPoint> read;
  std::optional<sim::UserError> error;
};

Outcome read_outcome(const sim::Config& config, sim::WorkMeter* meter) {
  Outcome outcome;
  try {
    outcome.read = read_point(config);
    outcome.read->frame.wait_with(meter);
  } catch (const sim::UserError& error) {
    outcome.error = error;
  }
  return outcome;
}

class Planner {
 public:
  Planner(sim::Config& config, std::span<const std::string> axes, sim::WorkMeter* meter,
          std::span<const AxisArgument> more, Unfit unfit)
      : config_(config),
        meter_(meter),
        prices_(keys::read_prices(config)),
        filter_(config.text("sweep.filter")),
        skip_scenes_(unfit == Unfit::left_out),
        skip_invalid_(config.boolean("sweep.skip_invalid") || skip_scenes_),
        table_(read_sweep_table(config, axes, more)),
        points_(config, table_),
        used_(config.schema().keys().size()) {
    refuse_records(config);
  }

  SweepPlan plan() {
    plan_.file = config_.name();
    plan_.leaves_out = skip_invalid_;
    plan_.prices = keys::read_given_prices(config_);
    plan_.question = read_question(config_);
    name_axes();
    const std::vector<std::uint64_t> passing = filter();
    find_strides_of_bases();
    sim::with_places(config_, [&] {
      keys::read_memory(config_).require(plan_bytes(passing.size(), plan_.axes.size()),
                                         "the plan of " + std::to_string(passing.size()) + " points takes",
                                         "split the sweep");
    });
    plan_.points.reserve(passing.size());
    found_.reserve(passing.size() + 1);
    for (std::size_t begin = 0; begin < passing.size(); begin += points_at_once) {
      add(std::span(passing).subspan(begin, std::min(points_at_once, passing.size() - begin)));
    }
    if (plan_.points.empty()) {
      sim::fail_at(config_, config_.free_section_line("sweep"), "sweep",
                   "no point of the sweep can be built; the first: " + plan_.skipped.front().reason);
    }
    add_compare();
    refuse_unused();
    std::move(found_).move_into(plan_);
    return std::move(plan_);
  }

 private:
  void name_axes() {
    if (points_.named()) {
      plan_.axes.emplace_back("point");
    }
    for (const std::size_t key : points_.keys()) {
      plan_.axes.push_back(config_.schema().names()[key]);
    }
    for (const SweepAxis& axis : table_.axes) {
      SweepDirection direction;
      const bool named = axis.kind == SweepAxis::Kind::named;
      if (named) {
        direction.keys.emplace_back("point");
        direction.steps = axis.names;
      } else {
        for (const std::size_t key : axis.keys) {
          direction.keys.push_back(config_.schema().names()[key]);
        }
        for (const std::vector<sim::Setting>& step : axis.steps) {
          std::string text;
          for (const sim::Setting& setting : step) {
            text += (text.empty() ? "" : " and ") +
                    plain_values(config_.schema().keys()[setting.key], setting.values);
          }
          direction.steps.push_back(std::move(text));
        }
      }
      plan_.directions.push_back(std::move(direction));
    }
  }

  std::vector<std::uint64_t> filter() {
    std::vector<std::uint64_t> passing;
    if (filter_.empty()) {
      passing.resize(points_.size());
      std::iota(passing.begin(), passing.end(), std::uint64_t{0});
      return passing;
    }
    SweepFilter filter(config_.schema(), filter_, points_.named(), config_.place("sweep.filter"));
    std::vector<sim::Value> values(filter.columns().size());
    for (std::uint64_t point = 0; point < points_.size(); ++point) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t key = filter.columns()[i];
        values[i] = key == FilterText::point ? sim::Value(points_.name(point)) : points_.value(point, key);
      }
      if (filter.passes(values)) {
        passing.push_back(point);
      }
    }
    if (passing.empty()) {
      config_.fail("sweep.filter", "no point of " + std::to_string(points_.size()) + " passes");
    }
    plan_.filtered_out = points_.size() - passing.size();
    return passing;
  }

  // Points that differ only in what their base machine overrides share one base machine.
  void find_strides_of_bases() {
    for (const SweepAxis& axis : table_.axes) {
      const bool overridden = std::ranges::all_of(axis.keys, [&](std::size_t key) {
        return table_.base.empty() ? is_set_for_one_node(config_.schema().names()[key])
                                   : std::ranges::any_of(table_.base, [&](const sim::Setting& setting) {
                                       return setting.key == key;
                                     });
      });
      shapes_base_.push_back(!overridden);
    }
  }
  [[nodiscard]] std::uint64_t base_group(std::uint64_t point) const {
    std::uint64_t group = 0;
    for (std::size_t axis = 0; axis < table_.axes.size(); ++axis) {
      if (shapes_base_[axis]) {
        group = group * table_.axes[axis].steps.size() + points_.step(point, axis);
      }
    }
    return group;
  }

  [[nodiscard]] Outcome read_base(std::uint64_t point, const ReadPoint& read) const {
    if (table_.base.empty()) {
      return read_outcome(one_node_config(read), meter_);
    }
    std::vector<sim::Setting> settings = points_.settings(point);
    settings.insert(settings.end(), table_.base.begin(), table_.base.end());
    return read_outcome(config_.with(settings), meter_);
  }

  void add(std::span<const std::uint64_t> points) {
    struct Both {
      Outcome point;
      Outcome base;
      bool wants_base = false;
    };
    std::vector<Both> read(points.size());
    std::unordered_map<std::uint64_t, std::size_t> wanted;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::uint64_t group = base_group(points[i]);
      read[i].wants_base = !bases_.contains(group) && wanted.emplace(group, i).second;
    }
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      read[i].point = read_outcome(config_.with(points_.settings(points[i])), meter_);
      if (read[i].wants_base && read[i].point.read) {
        read[i].base = read_base(points[i], *read[i].point.read);
      }
    });
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!read[i].point.read) {
        skip(points[i], *read[i].point.error, false);
        continue;
      }
      ReadPoint& point = *read[i].point.read;
      const std::uint64_t group = base_group(points[i]);
      if (!bases_.contains(group)) {
        // Only the group's first point reads the base; that point could not be built, so it is read here.
        enter_base(points[i], group,
                   read[i].wants_base ? std::move(read[i].base) : read_base(points[i], point));
      }
      if (const Base& base = bases_.at(group); base.machine) {
        enter_point(points[i], point, *base.machine);
      } else {
        skip(points[i], *base.error, !base.is_read);
      }
    }
  }

  void skip(std::uint64_t point, const sim::UserError& error, bool of_base) {
    if (!skip_invalid_) {
      throw sim::UserError(error.what() + std::string(of_base ? " (the base of the point " : " (the point ") +
                               sim::shown(text_of(point)) +
                               "; sweep.skip_invalid = true leaves out such points)",
                           error);
    }
    plan_.skipped.push_back(
        {text_of(point), error.what() + std::string(of_base ? " (its base)" : ""), points_.values(point)});
  }

  [[nodiscard]] std::string text_of(std::uint64_t point) const {
    return point_text(config_.schema(), plan_.axes, points_.values(point));
  }

  struct Entered {
    std::optional<std::size_t> machine;
    std::optional<sim::UserError> error;  // of the scene, if that may be left out
  };

  // A scene that is a file may be at fault, of which the point says the name.
  Entered enter_machine(std::uint64_t point, ReadPoint& read) {
    try {
      return {found_.enter(read), {}};
    } catch (const sim::UserError& error) {
      if (skip_scenes_) {
        return {{}, error};
      }
      throw sim::UserError(error.what() + (" (the point " + sim::shown(text_of(point))) + ")", error);
    }
  }

  void enter_base(std::uint64_t point, std::uint64_t group, Outcome base) {
    if (!base.read) {
      bases_.emplace(group, Base{{std::nullopt, base.error}, false});
      return;
    }
    note_use(base.read->config);
    bases_.emplace(group, Base{enter_machine(point, *base.read), true});
  }

  void enter_point(std::uint64_t number, ReadPoint& read, std::size_t base) {
    if (plan_.points.empty()) {
      config_.take_reasons(read.config);
    }
    note_use(read.config);
    const Entered entered = enter_machine(number, read);
    if (!entered.machine) {
      skip(number, *entered.error, false);
      return;
    }
    SweepPoint point;
    point.values = points_.values(number);
    point.machine = *entered.machine;
    point.base = base;
    point.cost = keys::cost_of(prices_, read.machine);
    found_.used_by_point(point.machine, plan_.points.size());
    plan_.points.push_back(std::move(point));
  }

  void add_compare() {
    if (!table_.compare) {
      return;
    }
    Outcome compare = read_outcome(config_.with(*table_.compare), meter_);
    if (!compare.read) {
      throw sim::UserError(compare.error->what() + std::string(" (the machine of [sweep.compare])"),
                           *compare.error);
    }
    refuse_unused(*table_.compare, compare.read->config, "the machine of [sweep.compare]");
    note_use(compare.read->config);
    plan_.compare = found_.enter(*compare.read);
  }

  void note_use(const sim::Config& read) {
    for (std::size_t key = 0; key < used_.size(); ++key) {
      used_[key] = used_[key] || read.used_at(key);
    }
  }

  void refuse_unused(const std::vector<sim::Setting>& settings, const sim::Config& read,
                     const std::string& who) const {
    for (const sim::Setting& setting : settings) {
      if (!read.used_at(setting.key)) {
        const std::string& key = config_.schema().names()[setting.key];
        const std::string reason(read.why_unused(key));
        sim::fail_at(config_, setting.line, key,
                     "is not used by " + who + (reason.empty() ? "" : ": " + reason));
      }
    }
  }

  // A key is unused only if no point uses it.
  void refuse_unused() {
    for (std::size_t key = 0; key < used_.size(); ++key) {
      if (used_[key]) {
        config_.use(key);
      }
    }
    for (const SweepAxis& axis : table_.axes) {
      for (const std::vector<sim::Setting>& step : axis.steps) {
        refuse_unused(step, config_, "any point of the sweep");
      }
    }
    refuse_unused(table_.base, config_, "any machine of the sweep");
    // An axis may, like an assignment, switch off a part of the file's own machine: that part's keys are no
    // error.
    if (const Outcome own = read_outcome(config_.with({}), meter_); own.read) {
      for (std::size_t key = 0; key < used_.size(); ++key) {
        if (own.read->config.used_at(key)) {
          config_.use(key);
        }
      }
    }
    config_.refuse_unused();
  }

  sim::Config& config_;
  sim::WorkMeter* meter_;
  keys::Prices prices_;
  std::string filter_;
  bool skip_scenes_;
  bool skip_invalid_;
  SweepTable table_;
  SweepPoints points_;
  std::vector<bool> used_;         // by any machine
  std::vector<bool> shapes_base_;  // of each axis
  // What the points of a group are measured against: a machine, or why it cannot be built.
  struct Base : Entered {
    bool is_read = false;  // its configuration is that of a machine
  };
  std::unordered_map<std::uint64_t, Base> bases_;
  MachineList found_;
  SweepPlan plan_;
};

}  // namespace

std::uint64_t plan_bytes(std::uint64_t points, std::size_t axes) {
  constexpr std::uint64_t overhead = 16;  // of an allocation
  constexpr std::uint64_t key = 48;       // a string of 32 digits, beside its object
  constexpr std::uint64_t sections = 16;  // at most so many sections of a configuration are read by a machine
  const std::uint64_t machine =
      sizeof(SweepMachine) + key + overhead + sections * sizeof(SettingsPart) + sizeof(std::size_t);
  // In the list of the machines, and in that of the timings.
  const std::uint64_t known = sizeof(std::pair<std::string, std::size_t>) + key + 4 * overhead;
  const std::uint64_t point = sizeof(SweepPoint) + overhead + axes * sizeof(sim::Value);
  // The last term is for the numbers by which machines are put in order.
  return points * (machine + 2 * known + point + 4 * sizeof(std::size_t));
}

SweepPlan plan_sweep(sim::Config& config, std::span<const std::string> axes, sim::WorkMeter* meter,
                     std::span<const AxisArgument> more, Unfit unfit) {
  return Planner(config, axes, meter, more, unfit).plan();
}

}  // namespace marti::studies::sweep
