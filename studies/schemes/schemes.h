// `marti study schemes`: the paper's section on parallel machines (McNeill et al. 1992, section 3) as runs:
// naive pixel parallelism, packets with caches, pipelining and space parallelism, on one scene and clock.
#pragma once

#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/tables/study_files.h"

namespace marti::studies::schemes {

/// Traces the scene once, times every machine from its log, and then trees of several cell sizes. Throws
/// UserError for anything wrong with the input.
/// `meter` is told how far the study is; null: nobody waits.
[[nodiscard]] tables::StudyOutput run_schemes(sim::Config& config, sim::WorkMeter* meter = nullptr);

}  // namespace marti::studies::schemes
