#include "sim/time.h"

#include <cmath>

#include "sim/key_error.h"

namespace marti::sim {

void fail_time_overflow() {
  throw TimeOverflow(
      "simulated time does not fit in 63 bits of picoseconds (107 days): "
      "use a faster clock, shorter latencies or a smaller image");
}

Clock Clock::from_hertz(double hertz) {
  if (!(hertz >= 1.0 && hertz <= 1e12)) {
    throw UserError("a clock must lie between 1 Hz and 1 THz");
  }
  const auto period = static_cast<Ticks>(std::llround(static_cast<double>(ticks_per_second) / hertz));
  return Clock(period < 1 ? 1 : period);
}

Clock Clock::from_period(Ticks period) {
  if (period < 1) {
    throw UserError("a clock's period must be at least 1 ps");
  }
  return Clock(period);
}

}  // namespace marti::sim
