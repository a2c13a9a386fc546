// Everything one `marti run` found out.
#pragma once

#include <string>
#include <vector>

#include "processors/machine_config.h"
#include "processors/replay.h"
#include "sim/config.h"
#include "studies/functional_run.h"
#include "studies/scaling.h"

namespace marti::studies {

struct RunResult {
  std::string config_name;
  std::vector<sim::EffectiveValue> values;
  FrameConfig frame_config;
  processors::MachineConfig machine;
  FunctionalRun functional;
  processors::MachineResult timed;
  Scaling scaling;
  Finding finding;
};

/// Runs a configuration: one functional run, the machine and the same machine with one node. Throws
/// UserError for anything wrong with the input, before it has written anything.
[[nodiscard]] RunResult run(sim::Config& config);

/// The schema of `marti run`.
[[nodiscard]] sim::Schema run_schema();

/// The printed summary.
[[nodiscard]] std::string summary_of(const RunResult& result);

/// The result for programs, as docs/result-schema.md describes it. The same run gives the same bytes.
[[nodiscard]] std::string json_of(const RunResult& result);

}  // namespace marti::studies
