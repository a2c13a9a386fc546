// The waits at one queue: exact sum and maximum, and a log-scaled histogram for percentiles.
#pragma once

#include <cstdint>

#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::memory {

struct WaitStatistics {
  std::int64_t count = 0;
  sim::Sum sum = 0;  ///< equals the queue length integrated over time (Little's law as an identity)
  sim::Ticks max = 0;
  sim::LogHistogram histogram;

  [[gnu::always_inline]] void add(sim::Ticks wait) {
    ++count;
    sum += wait;
    histogram.add(wait);
    max = histogram.maximum();
  }
  /// Adds `tenures` that did not wait.
  void add_unwaited(std::int64_t tenures) {
    count += tenures;
    histogram.add_repeated(0, tenures);
  }

  static constexpr auto counters() {
    using C = sim::Counter<WaitStatistics>;
    return std::array{C{"count", "1", "tenures, those that did not wait included", &WaitStatistics::count},
                      C{"sum", "ps", "all waits together", &WaitStatistics::sum},
                      C{"max", "ps", "the longest wait", &WaitStatistics::max, sim::MergeRule::maximum}};
  }
};

}  // namespace marti::memory
