// A sweep of one frame with all its machines timed, and what really helps its points.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/error.h"
#include "studies/helps/what_helps.h"
#include "studies/limits/sweep_limits.h"
#include "studies/run/functional_run.h"
#include "studies/sweep/plan/sweep_plan.h"

namespace marti::test {

class TimedSweep {
 public:
  /// `config` is of studies::sweep_schema(). Throws UserError for a sweep of several frames.
  explicit TimedSweep(sim::Config config)
      : config_(std::move(config)),
        prices_(studies::keys::read_given_prices(config_)),
        plan_(studies::sweep::plan_sweep(config_)) {
    if (plan_.frames.size() != 1) {
      throw sim::UserError("the sweep must have one frame");
    }
    run_ = studies::run::run_functional(plan_.frames[0].config);
    for (const studies::sweep::SweepMachine& machine : plan_.machines) {
      processors::replay::ReplayOptions options;
      options.stripped = stripped(machine.config).get();
      results_.push_back(processors::replay::replay(*run_.frame.log, machine.config, options));
    }
  }

  [[nodiscard]] std::size_t points() const { return plan_.points.size(); }
  [[nodiscard]] const std::optional<studies::keys::Prices>& prices() const { return prices_; }
  [[nodiscard]] const processors::machine::MachineConfig& machine(std::size_t point) const {
    return plan_.machines[plan_.points[point].machine].config;
  }
  [[nodiscard]] const processors::replay::MachineResult& result(std::size_t point) const {
    return results_[plan_.points[point].machine];
  }

  /// The configuration of a point's machine.
  [[nodiscard]] sim::Config config(std::size_t point) const {
    std::vector<sim::Setting> settings;
    for (std::size_t i = 0; i < plan_.axes.size(); ++i) {
      if (const std::optional<std::size_t> key = config_.schema().find(plan_.axes[i])) {
        settings.push_back({*key, {plan_.points[point].values[i]}, 0, plan_.axes[i]});
      }
    }
    return config_.with(settings);
  }

  /// The configuration made of the settings that a sweep's store keeps of the machine.
  [[nodiscard]] sim::Config stored_config(std::size_t point) const {
    std::vector<std::string> assignments;
    for (const sim::EffectiveValue& value :
         studies::sweep::all_of(plan_.machines[plan_.points[point].machine].settings)) {
      assignments.push_back(value.key + "=" + value.value);
    }
    return sim::Config::from_text(config_.schema(), "", "store", assignments);
  }

  [[nodiscard]] studies::limits::SweepLimits limits(
      std::optional<studies::keys::Prices> prices = std::nullopt) const {
    std::vector<studies::limits::LimitPoint> timed;
    for (std::size_t i = 0; i < points(); ++i) {
      timed.push_back(
          {config(i), studies::limits::point_figures(studies::figures::counts_of(machine(i), result(i)))});
      const std::size_t base = plan_.points[i].base;
      if (plan_.machines[base].config.all_nodes() == 1) {
        timed.back().one_node = studies::limits::point_figures(
            studies::figures::counts_of(plan_.machines[base].config, results_[base]));
      }
    }
    std::vector<std::string> keys;
    for (const std::string& axis : plan_.axes) {
      if (config_.schema().find(axis)) {
        keys.push_back(axis);
      }
    }
    return {std::move(keys), std::move(timed), prices};
  }

  /// Every step, replayed. With prices also those that cannot be among the three that save most.
  [[nodiscard]] studies::helps::WhatHelps measure(std::size_t point,
                                                  const std::optional<studies::keys::Prices>& prices) {
    return studies::helps::what_helps(
        config(point), prices, machine(point), result(point),
        {*run_.frame.log, stripped(machine(point)), {}, plan_.frames[0].config.memory});
  }

 private:
  using Stripped = std::shared_ptr<const processors::walk::StrippedLog>;

  [[nodiscard]] const Stripped& stripped(const processors::machine::MachineConfig& machine) {
    using processors::walk::StrippedLog;
    const std::string key = StrippedLog::key_of(machine);
    Stripped& log = stripped_[{key, StrippedLog::ways_of(machine)}];
    if (log == nullptr && !key.empty()) {
      log = StrippedLog::make(*run_.frame.log, machine);
    }
    return log;
  }

  sim::Config config_;
  std::optional<studies::keys::Prices> prices_;
  studies::sweep::SweepPlan plan_;
  studies::run::FunctionalRun run_;
  std::map<std::pair<std::string, std::uint32_t>, Stripped> stripped_;
  std::vector<processors::replay::MachineResult> results_;
};

}  // namespace marti::test
