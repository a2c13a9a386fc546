// `marti study stability`: extremes of a user's scene and machine, each against an oracle.
#pragma once

#include <span>

#include "sim/config.h"
#include "sim/schema.h"
#include "sim/work_meter.h"
#include "studies/stability/stability_case.h"
#include "studies/tables/study_files.h"

namespace marti::studies::stability {

void declare_stability_keys(sim::Schema& schema);

/// The schema of `marti study stability`: that of `marti run`, and a section of its own.
[[nodiscard]] sim::Schema stability_schema();

/// Runs every case that the configuration chooses. When one fails, the output's `fault` says which. Throws
/// UserError for anything wrong with the input. `meter` is told how far the study is; null: nobody waits.
[[nodiscard]] tables::StudyOutput run_stability(sim::Config& config, sim::WorkMeter* meter = nullptr);

/// Like the function above, with other cases than stability_cases().
[[nodiscard]] tables::StudyOutput run_stability(sim::Config& config, std::span<const StabilityCase> cases,
                                                sim::WorkMeter* meter = nullptr);

}  // namespace marti::studies::stability
