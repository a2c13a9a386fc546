#include "processors/cost/accounting.h"

#include <numeric>

namespace marti::processors::cost {

std::int64_t ReferenceCounts::all_hits() const {
  return std::accumulate(hits.begin(), hits.end(), std::int64_t{0});
}

std::int64_t ReferenceCounts::all_misses() const {
  return std::accumulate(misses.begin(), misses.end(), std::int64_t{0});
}

ReferenceCounts& ReferenceCounts::operator+=(const ReferenceCounts& other) {
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    hits[kind] += other.hits[kind];
    misses[kind] += other.misses[kind];
  }
  return *this;
}

std::array<std::int64_t, memory::record_kinds> records_of(const StepCounts& steps, bool leaf_records) {
  return {steps.branches + (leaf_records ? steps.leaves : 0) + steps.cuts,
          steps.transforms,
          steps.lists,
          steps.tests,
          steps.shades + steps.passes + steps.any_hits,
          steps.texels,
          steps.pixels};
}

sim::Ticks sum_of(const TimeDivision& time) {
  sim::Ticks sum = 0;
  for (const sim::Ticks part : time) {
    sum = sim::add_ticks(sum, part);
  }
  return sum;
}

}  // namespace marti::processors::cost
