// The processor time that this process has used.
#pragma once

#include <ctime>

#include "sim/error.h"

namespace marti::studies {

/// Seconds of all its threads, by CLOCK_PROCESS_CPUTIME_ID. Throws InternalError where there is no such
/// clock.
[[nodiscard]] inline double process_cpu_seconds() {
  std::timespec now{};
  sim::ensure(clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) == 0, "the process has no clock of its own");
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace marti::studies
