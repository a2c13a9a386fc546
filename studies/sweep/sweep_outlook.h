// What a sweep will take, by tracing and timing a small image.
#pragma once

#include <vector>

#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies::sweep {

/// An estimate for the machines that are not done, with so many of them timed at a time: some frames are
/// traced small (frame_samples.h), and some machines timed on these (machine_samples.h). Samples are begun
/// for 1.3 seconds at most, and none is large (most_sample_bytes); where only large ones could be taken, the
/// time is not estimated.
[[nodiscard]] SweepOutlook outlook_of(const SweepPlan& plan, const std::vector<bool>& machines_done,
                                      const std::vector<bool>& frames_done, unsigned threads);

}  // namespace marti::studies::sweep
