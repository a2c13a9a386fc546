// `marti study error`: how wrong cheaper answers are, and how much cheaper they are.
#pragma once

#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/tables/study_files.h"

namespace marti::studies::error {

/// The cheaper ways to a frame time and to an image against exact ones. Throws UserError for anything wrong
/// with the input. `meter` is told how far the study is; null: nobody waits.
[[nodiscard]] tables::StudyOutput run_error(sim::Config& config, sim::WorkMeter* meter = nullptr);

}  // namespace marti::studies::error
