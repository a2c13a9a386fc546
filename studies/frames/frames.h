// `marti study frames`: the cycle "build, render" of each frame of an animated scene, for a tree that is
// rebuilt, rebuilt in part, built on demand, or both. (Space subdivision in dynamic scenes: McNeill, Shah,
// Hébert, Lister, Grimsdale, Computer Graphics Forum 11(4), 1992.)
#pragma once

#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/tables/study_files.h"

namespace marti::studies::frames {

/// Poses, builds, renders and times all frames, one after the other. Throws UserError for anything wrong with
/// the input, InternalError when an updated tree is not the one of a fresh build or gives another image. The
/// reproducible tables, the images and the report do not depend on the number of host threads.
/// `meter` is told how far the study is; null: nobody waits.
[[nodiscard]] tables::StudyOutput run_frames(sim::Config& config, sim::WorkMeter* meter = nullptr);

}  // namespace marti::studies::frames
