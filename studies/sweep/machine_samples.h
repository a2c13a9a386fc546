// Some machines of a sweep, timed on the samples of its frames: what all of them will take.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "studies/sweep/frame_samples.h"
#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies::sweep {

/// Seconds of processor time.
struct MachinesEstimate {
  std::vector<double>
      of_frame;            ///< to time one machine, for each frame of the plan; 0 for frames without machines
  double timing = 0.0;     ///< of all, one thread for each machine
  double stripping = 0.0;  ///< on all threads
};

/// Times some of `machines`, chosen by chance from those that take at most `most_sample_bytes`, at least one;
/// then none is begun any more when `enough()`. `frame_of(i)` is the estimate for frame i of the plan.
/// std::nullopt when no machine could be timed.
[[nodiscard]] std::optional<MachinesEstimate> estimate_machines(
    const SweepPlan& plan, const std::vector<std::size_t>& machines, const FrameSamples& samples,
    const std::function<const FrameEstimate&(std::size_t frame)>& frame_of,
    const std::function<bool()>& enough);

}  // namespace marti::studies::sweep
