#include "memory/shared_cache.h"

#include <algorithm>
#include <bit>

namespace marti::memory {

SharedCache::SharedCache(const SharedCacheConfig& config)
    : line_shift_(static_cast<unsigned>(std::countr_zero(config.cache.line))),
      hit_ticks_(config.clock.cycles(config.hit_cycles)),
      tags_(config.cache, 1) {}

std::optional<SharedCache::Hit> SharedCache::read(Address address, sim::Ticks arrival) {
  const auto line = static_cast<std::uint32_t>(address >> line_shift_);
  if (!tags_.access(0, line)) {
    ++statistics_.lookups.misses;
    missed_ = line;
    missed_at_ = arrival;
    return std::nullopt;
  }
  ++statistics_.lookups.hits;
  sim::Ticks start = arrival;
  if (const auto coming = coming_.find(line); coming != coming_.end()) {
    start = std::max(arrival, coming->second - hit_ticks_);
  }
  statistics_.waits.add(start - arrival);
  return Hit{start, sim::add_ticks(start, hit_ticks_)};
}

void SharedCache::fill(sim::Ticks ready) {
  if (coming_.size() >= most_coming_) {
    forget_arrived(missed_at_);
    most_coming_ = std::max<std::size_t>(64, 2 * coming_.size());
  }
  coming_.insert_or_assign(missed_, ready);
}

void SharedCache::forget_arrived(sim::Ticks now) {
  std::erase_if(coming_, [&](const auto& line) { return line.second <= now; });
}

}  // namespace marti::memory
