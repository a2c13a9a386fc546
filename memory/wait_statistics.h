// The waits at one queue: exact sum and maximum, and a log-scaled histogram for percentiles.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::memory {

struct WaitStatistics {
  std::int64_t count = 0;
  sim::Ticks sum = 0;  ///< equals the area under the queue's length (Little's law as an identity)
  sim::Ticks max = 0;
  sim::LogHistogram histogram;

  void add(sim::Ticks wait) {
    ++count;
    sum = sim::add_ticks(sum, wait);
    max = std::max(max, wait);
    histogram.add(wait);
  }
};

}  // namespace marti::memory
