// Where the worker threads of a sweep get their tasks and bring their results.
#pragma once

#include <cstddef>
#include <cstdint>

#include "studies/sweep/plan/sweep_row.h"
#include "studies/sweep/work/schedule.h"

namespace marti::studies::sweep {

/// Thread-safe. In the program it is the schedule itself (sweep/work/coordinator.h).
class TaskSource {
 public:
  virtual ~TaskSource() = default;
  /// The next task, never `wait`: it blocks until there is one.
  [[nodiscard]] virtual SweepTask next() = 0;
  /// The log is in the cache of logs.
  virtual void traced(std::size_t frame, const FrameRow& row, std::int64_t cpu_nanoseconds) = 0;
  virtual void timed(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) = 0;
  /// Some worker has failed: every next() from now on gives `end`.
  virtual void stop() = 0;
};

}  // namespace marti::studies::sweep
