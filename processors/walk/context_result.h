// What is counted of the nodes' contexts and prefetches.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/statistics.h"

namespace marti::processors::walk {

/// What one processor node counted. issued = useful + useless.
struct ContextCounts {
  std::int64_t switches = 0;
  std::int64_t joined = 0;
  std::int64_t issued = 0;
  std::int64_t useful = 0;
  std::int64_t useless = 0;
  std::int64_t late = 0;
  std::int64_t dropped = 0;

  static constexpr auto counters() {
    using C = sim::Counter<ContextCounts>;
    return std::array{
        C{"switches", "1", "times that another context was taken up", &ContextCounts::switches},
        C{"joined", "1", "waits for a line that another context was fetching", &ContextCounts::joined},
        C{"issued", "1", "lines prefetched", &ContextCounts::issued},
        C{"useful", "1", "of these, referred to before they were pushed out", &ContextCounts::useful,
          sim::MergeRule::sum, sim::Better::higher},
        C{"useless", "1", "of these, pushed out or left over without a reference", &ContextCounts::useless},
        C{"late", "1", "waits for a prefetched line that was still under way", &ContextCounts::late},
        C{"dropped", "1", "prefetches left out because too many were under way", &ContextCounts::dropped}};
  }
};
static_assert(sim::declares_every_member<ContextCounts>());

struct ContextResult {
  std::vector<ContextCounts> nodes;  ///< one for each processor node; empty with one context and no prefetch

  [[nodiscard]] ContextCounts counts() const {
    ContextCounts sum;
    for (const ContextCounts& node : nodes) {
      sim::merge(sum, node);
    }
    return sum;
  }
};

}  // namespace marti::processors::walk
