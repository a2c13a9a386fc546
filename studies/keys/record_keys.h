// The configuration keys of what a run records beside its result.
#pragma once

#include "sim/config.h"
#include "sim/schema.h"
#include "studies/run/record/timeline.h"

namespace marti::studies::keys {

/// What is recorded; timelines and heat maps go to files in the output directory only.
struct RecordConfig {
  bool timeline = false;
  run::TimelineOptions timeline_options;
  bool heat_maps = false;
  bool critical_path = false;
  sim::Ticks interval = 0;  ///< 0: no figures by intervals
};

void declare_record_keys(sim::Schema& schema);

/// Throws UserError naming file, line and key, also when a file is to be recorded and there is no output
/// directory to record it in.
[[nodiscard]] RecordConfig read_record(sim::Config& config, bool has_directory);

}  // namespace marti::studies::keys
