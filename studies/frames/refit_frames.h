// `marti study frames` with a bounding volume hierarchy: how much longer frames take when the tree is
// refitted instead of rebuilt, and how many of its records either way writes.
#pragma once

#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/frames/frames_config.h"
#include "studies/tables/study_files.h"

namespace marti::studies::frames {

/// Traces and times each frame with a tree that is built for it and with the first frame's tree refitted to
/// it; hits and images must be equal, else InternalError. With kept instances there is one way more: the tree
/// that is built, whose meshes' trees are kept where nothing in them has moved. The trees are given when a
/// frame begins: no time for making them is charged.
[[nodiscard]] tables::StudyOutput run_refit_frames(sim::Config& config, const FramesConfig& frames);

}  // namespace marti::studies::frames
