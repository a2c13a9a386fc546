// The processor time that this process, and this thread, has used.
#pragma once

#include <cstdint>
#include <ctime>

#include "sim/error.h"

namespace marti::sim {

/// Nanoseconds by `clock`. Throws InternalError where there is no such clock.
[[nodiscard]] inline std::int64_t clock_nanoseconds(clockid_t clock) {
  timespec now{};
  ensure(clock_gettime(clock, &now) == 0, "there is no clock of processor time");
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// Seconds of all threads of this process.
[[nodiscard]] inline double process_cpu_seconds() {
  return 1e-9 * static_cast<double>(clock_nanoseconds(CLOCK_PROCESS_CPUTIME_ID));
}

/// Nanoseconds of the calling thread alone.
[[nodiscard]] inline std::int64_t thread_cpu_nanoseconds() {
  return clock_nanoseconds(CLOCK_THREAD_CPUTIME_ID);
}

/// Seconds of the calling thread alone.
[[nodiscard]] inline double thread_cpu_seconds() {
  return 1e-9 * static_cast<double>(thread_cpu_nanoseconds());
}

}  // namespace marti::sim
