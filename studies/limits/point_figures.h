// The figures of a timed point that predictions rest on.
#pragma once

#include "studies/figures/counted_figures.h"

namespace marti::studies::limits {

/// Sums over all nodes, clusters and banks; times in ps. 0 where the machine has no such part.
struct PointFigures {
  double end = 0.0;
  double packets = 0.0;
  double pixels = 0.0;
  double database_bytes = 0.0;
  double computing = 0.0;  ///< traversal, intersection, shading, building, switching, messaging
  double cache_access = 0.0;
  double transfer = 0.0;
  double bank_access = 0.0;
  double delays = 0.0;  ///< waits for packets, messages and locks
  double queue_full_wait = 0.0;
  double idle = 0.0;
  double earliest_finish = 0.0;  ///< when the first node learned that no packet was left
  double host_requests = 0.0;
  double references = 0.0;  ///< of the first-level caches
  double misses = 0.0;      ///< of the first-level caches
  double reads = 0.0;       ///< of the interconnects
  double writes = 0.0;
  double interconnect_busy = 0.0;
  double links = 0.0;
  double bank_busy = 0.0;
  double most_bank_busy = 0.0;  ///< of the busiest bank
  double bank_waits = 0.0;
};

[[nodiscard]] PointFigures point_figures(const figures::Counts& counts);

}  // namespace marti::studies::limits
