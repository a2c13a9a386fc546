// What a sweep will take, by tracing and timing a small image.
#pragma once

#include <vector>

#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies {

/// An estimate for the machines that are not done, with so many of them timed at a time. Takes at most
/// about 1.5 seconds, unless a single scene takes longer to be read and sorted: some frames are traced small
/// (frame_samples.h), and some machines timed on these (machine_samples.h).
[[nodiscard]] SweepOutlook outlook_of(const SweepPlan& plan, const std::vector<bool>& machines_done,
                                      const std::vector<bool>& frames_done, unsigned threads);

}  // namespace marti::studies
