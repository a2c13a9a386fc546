// A functional run as a sweep keeps it: no image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "processors/program/work_log.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/plan/sweep_row.h"

namespace marti::studies::sweep {

struct FrameLog {
  std::shared_ptr<const processors::program::WorkLog> log;
  FrameRow row;
};

/// Traces a frame of the plan. Throws UserError, at the place of the key, for a scene that cannot be traced
/// or has changed since it was planned.
[[nodiscard]] FrameLog trace_frame(const SweepPlan& plan, std::size_t frame);

/// Bytes of memory that a log takes, with what its vectors have in reserve.
[[nodiscard]] std::uint64_t memory_of(const processors::program::WorkLog& log);

}  // namespace marti::studies::sweep
