// Where a difference of two frame times comes from: every tick of a node belongs to one activity, so that the
// mean times of a node in all activities add up to the frame time, and their changes to its change.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/compare/figures.h"

namespace marti::studies::compare {

/// The time of a machine's nodes in one activity. A mean of a node is the nodes' time by their number.
struct ActivityTime {
  std::string activity;
  std::int64_t a = 0;       ///< of all nodes of A, ps
  std::int64_t b = 0;       ///< of all nodes of B, ps
  std::int64_t mean_a = 0;  ///< of a node, rounded to ps
  std::int64_t mean_b = 0;
  double change = 0.0;  ///< of the mean, ps, before rounding
};

/// The largest change first, then by the order of the activities. Activities in which neither spends time
/// are left out. Empty when a result lacks the times or the number of its nodes, or their sum is not the
/// frame time (somebody has changed the file).
[[nodiscard]] std::vector<ActivityTime> activity_times(const ComparedResult& a, const ComparedResult& b);

}  // namespace marti::studies::compare
