// A functional run as a sweep keeps it: no image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "processors/program/work_log.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/plan/sweep_row.h"

namespace marti::studies::sweep {

struct FrameLog {
  std::shared_ptr<const processors::program::WorkLog> log;
  FrameRow row;
};

/// Traces a frame of the plan. Throws UserError, at the place of the key, for a scene that cannot be traced
/// or has changed since it was planned; it names what asks for the frame.
[[nodiscard]] FrameLog trace_frame(const SweepPlan& plan, std::size_t frame);

/// " (the point cache.ways = 8 on teapot:4)": a point that asks for the machine, with its scene; where none
/// does, what the configuration gives the machine.
[[nodiscard]] std::string asked_by(const SweepPlan& plan, std::size_t machine);

/// The settings of a machine and its frame.
[[nodiscard]] std::vector<sim::EffectiveValue> settings_of(const SweepPlan& plan, std::size_t machine);

/// Bytes of memory that a log takes, with what its vectors have in reserve.
[[nodiscard]] std::uint64_t memory_of(const processors::program::WorkLog& log);

}  // namespace marti::studies::sweep
