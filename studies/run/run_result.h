// Everything one `marti run` found out.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/passes/working_set.h"
#include "processors/path/critical_path.h"
#include "processors/replay/bounds.h"
#include "processors/replay/replay.h"
#include "sim/config.h"
#include "sim/statistics.h"
#include "studies/figures/derived_figures.h"
#include "studies/helps/what_helps.h"
#include "studies/progress/whole_estimate.h"
#include "studies/run/functional_run.h"
#include "studies/run/kept_stripped_logs.h"
#include "studies/run/record/heat_map.h"
#include "studies/run/record/timeline.h"
#include "studies/tables/table.h"

namespace marti::studies::run {

struct RunResult {
  std::string config_name;
  std::vector<sim::EffectiveValue> values;
  keys::FrameConfig frame_config;
  Plan plan;  ///< what was left out of the frame and of the machine
  processors::machine::MachineConfig machine;
  FunctionalRun functional;
  processors::replay::MachineResult timed;
  processors::replay::MachineResult one_node;  ///< the same machine with one cluster of one node
  figures::Counts counts;                      ///< of the timed machine
  figures::Counts one_node_counts;
  std::optional<helps::WhatHelps> helps;  ///< empty: not asked for
  processors::replay::FrameBounds bounds;
  std::optional<processors::replay::Prediction> prediction;
  std::optional<processors::passes::WorkingSet> working_set;  ///< of the timed machine; empty: not asked for
  std::optional<processors::path::CriticalPath>
      critical_path;                       ///< of the timed machine; empty: not asked for
  std::unique_ptr<Timeline> timeline;      ///< written, but not under its own name yet; null: not asked for
  std::unique_ptr<HeatMap> heat_map;       ///< null: not asked for
  std::optional<tables::Table> intervals;  ///< figures by intervals; empty: not asked for

  /// A figure of the timed machine (studies/figures/derived_figures.h), measured against one node.
  [[nodiscard]] std::optional<double> figure(std::string_view name) const {
    return figures::figure_of({&counts, &one_node_counts}, name);
  }
  /// A counted figure of the timed machine; 0 where the machine has no such part. Not for sums of times over
  /// nodes, which may not fit: then an InternalError.
  [[nodiscard]] std::int64_t count(std::string_view name) const {
    const figures::Count value = figures::count_of(counts, name).value_or(0);
    const auto fits = static_cast<std::int64_t>(value);
    sim::ensure(fits == value, "a counted figure does not fit in 64 bits");
    return fits;
  }
  /// The counted figures that a component's counters are merged into: those whose names begin with `prefix`.
  template <sim::HasCounters S>
  [[nodiscard]] S counters(const std::string& prefix) const {
    S sum;
    for (const sim::Counter<S>& counter : S::counters()) {
      counter.set(sum, figures::count_of(counts, prefix + std::string(counter.name)).value_or(0));
    }
    return sum;
  }
};

struct RunOptions {
  /// Where the images and what is recorded while the machine runs go; it must exist. Empty: nothing may be
  /// recorded.
  std::filesystem::path directory{};
  KeptItems keep{};
  /// The functional run of the frame that the configuration describes; empty: it is to be made.
  std::optional<FunctionalRun> functional{};
  helps::Measuring what_helps = helps::Measuring::none;  ///< of what would make the frame shorter
  std::optional<keys::Prices> prices{};                  ///< by which that is chosen
  /// Stripped logs of that functional run, taken from here and kept here; null: none.
  KeptStrippedLogs* stripped_logs = nullptr;
  /// Is told how far the run is; after its stop() the run soon throws sim::Stopped. Null: nobody waits.
  sim::WorkMeter* meter = nullptr;
  progress::Foreseen* foreseen = nullptr;  ///< is told how long the meter's parts take; null: nobody asks
};

/// Runs a configuration: one functional run, the machine and the same machine with one node. Throws UserError
/// for anything wrong with the input, before it has written anything.
[[nodiscard]] RunResult run(sim::Config& config, RunOptions options = {});

/// Runs the frame and the machine of `first` again, with these items of the plan kept. Nothing is recorded.
[[nodiscard]] RunResult run_again(const RunResult& first, const KeptItems& keep);

/// Throws UserError when the simulated machine would take more of the computer's memory than the frame may.
void refuse_beyond_memory(const sim::Config& config, const keys::FrameConfig& frame,
                          const processors::machine::MachineConfig& machine);
/// Throws UserError when more than one frame is asked for.
void refuse_several_frames(const sim::Config& config, const keys::FrameRange& frames);

/// The schema of `marti run`.
[[nodiscard]] sim::Schema run_schema();

}  // namespace marti::studies::run
