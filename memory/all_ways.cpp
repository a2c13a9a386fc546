#include "memory/all_ways.h"

#include <numeric>
#include <string>
#include <utility>

#include "memory/cache_config.h"
#include "sim/error.h"

namespace marti::memory {

std::int64_t WaysHistogram::misses(std::uint32_t ways) const {
  sim::ensure(ways <= hits.size(), "misses of as many ways as were counted");
  return references - std::accumulate(hits.begin(), hits.begin() + ways, std::int64_t{0});
}

WaysHistogram& WaysHistogram::operator+=(const WaysHistogram& other) {
  sim::ensure(sets == other.sets && hits.size() == other.hits.size(), "the caches added up are the same");
  references += other.references;
  for (std::size_t d = 0; d < hits.size(); ++d) {
    hits[d] += other.hits[d];
  }
  return *this;
}

AllWays::AllWays(std::vector<std::uint32_t> set_counts, std::uint32_t most_ways) : most_ways_(most_ways) {
  std::sort(set_counts.begin(), set_counts.end());
  if (set_counts.empty() || set_counts.front() == 0 || most_ways == 0) {
    throw sim::UserError("caches of all ways need at least one set and one way");
  }
  if (std::adjacent_find(set_counts.begin(), set_counts.end()) != set_counts.end()) {
    throw sim::UserError("a number of sets is given twice");
  }
  for (std::size_t i = 0; i < set_counts.size(); ++i) {
    const std::uint32_t sets = set_counts[i];
    if (std::uint64_t{sets} * most_ways > most_lines) {
      throw sim::UserError("caches of " + std::to_string(sets) + " sets of up to " +
                           std::to_string(most_ways) + " lines are beyond 2^28 lines");
    }
    const bool refined = std::all_of(set_counts.begin() + static_cast<std::ptrdiff_t>(i), set_counts.end(),
                                     [&](std::uint32_t later) { return later % sets == 0; });
    forests_.push_back({sets, SetIndex(sets), refined,
                        std::vector<std::uint32_t>(std::size_t{sets} * most_ways, no_line),
                        std::vector<std::int64_t>(most_ways)});
  }
}

void AllWays::clear() {
  for (Forest& forest : forests_) {
    std::fill(forest.tags.begin(), forest.tags.end(), no_line);
  }
}

std::vector<WaysHistogram> AllWays::histograms() const {
  std::vector<WaysHistogram> histograms;
  std::int64_t taken = 0;
  for (const Forest& forest : forests_) {
    WaysHistogram histogram{forest.sets, references_, forest.hits};
    histogram.hits[0] += taken;
    taken = forest.refined ? histogram.hits[0] : taken;
    histograms.push_back(std::move(histogram));
  }
  return histograms;
}

}  // namespace marti::memory
