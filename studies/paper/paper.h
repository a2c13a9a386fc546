// `marti study paper`: the tables and figures of McNeill, Shah, Hébert, Lister, Grimsdale, "Performance of
// Space Subdivision Techniques in Ray Tracing", Computer Graphics Forum 11(4), 1992.
#pragma once

#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/tables/study_files.h"

namespace marti::studies::paper {

/// Runs the whole study. Throws UserError for anything wrong with the input. The reproducible tables and the
/// report do not depend on the number of host threads.
/// `meter` is told how far the study is; null: nobody waits.
[[nodiscard]] tables::StudyOutput run_paper(sim::Config& config, sim::WorkMeter* meter = nullptr);

}  // namespace marti::studies::paper
