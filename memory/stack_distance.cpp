#include "memory/stack_distance.h"

#include <algorithm>
#include <numeric>

#include "sim/error.h"

namespace marti::memory {

std::int64_t StackHistogram::misses(std::uint64_t lines) const {
  const auto end = hits.begin() + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(lines, hits.size()));
  return references - std::accumulate(hits.begin(), end, std::int64_t{0});
}

std::uint64_t StackHistogram::lines_for(std::int64_t most_misses) const {
  sim::ensure(most_misses >= compulsory, "no cache misses fewer than the first uses");
  std::int64_t missed = references;
  std::uint64_t lines = 0;
  while (missed > most_misses) {
    missed -= hits[lines++];
  }
  return lines;
}

StackHistogram& StackHistogram::operator+=(const StackHistogram& other) {
  references += other.references;
  compulsory += other.compulsory;
  hits.resize(std::max(hits.size(), other.hits.size()));
  for (std::size_t d = 0; d < other.hits.size(); ++d) {
    hits[d] += other.hits[d];
  }
  return *this;
}

void StackDistances::first_use() {
  ++compulsory_;
  if (order_.lines() > hits_.size()) {
    hits_.resize(std::max<std::size_t>(order_.lines(), 2 * hits_.size()));
  }
}

void StackDistances::clear() {
  order_.clear();
  newest_ = no_line;
}

StackHistogram StackDistances::histogram() const {
  StackHistogram histogram{0, compulsory_, hits_};
  if (repeats_ != 0) {
    histogram.hits[0] += repeats_;
  }
  while (!histogram.hits.empty() && histogram.hits.back() == 0) {
    histogram.hits.pop_back();
  }
  histogram.references = std::accumulate(histogram.hits.begin(), histogram.hits.end(), compulsory_);
  return histogram;
}

}  // namespace marti::memory
