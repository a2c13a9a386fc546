// What a sweep will take, by tracing and timing a small image.
#pragma once

#include <vector>

#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies {

/// An estimate for the machines that are not done, with so many of them timed at a time. Frames are sampled
/// with at most 64 pixels a side, and only the first few of them; of each, the middle one of the machines
/// that are left is timed on the sample, with a stripped log if it will have one, and stands for all.
[[nodiscard]] SweepOutlook outlook_of(const SweepPlan& plan, const std::vector<bool>& machines_done,
                                      const std::vector<bool>& frames_done, unsigned threads);

}  // namespace marti::studies
