// `marti study frames` with a bounding volume hierarchy: the cycle "make the tree, render" of each frame when
// the tree is rebuilt, rebuilt at the top alone, or refitted.
#pragma once

#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/frames/frames_config.h"
#include "studies/tables/study_files.h"

namespace marti::studies::frames {

/// Traces and times each frame with a tree that is built for it and with the first frame's tree refitted to
/// it; hits and images must be equal, else InternalError. With kept instances there is one way more: the tree
/// that is built, whose meshes' trees are kept where nothing in them has moved. What is told of making a tree
/// is the least time that it takes (processors/cost/tree_work.h).
[[nodiscard]] tables::StudyOutput run_refit_frames(sim::Config& config, const FramesConfig& frames);

}  // namespace marti::studies::frames
