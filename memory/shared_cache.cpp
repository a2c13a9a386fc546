#include "memory/shared_cache.h"

#include <algorithm>
#include <bit>

namespace marti::memory {

SharedCache::SharedCache(const SharedCacheConfig& config)
    : line_shift_(static_cast<unsigned>(std::countr_zero(config.cache.line))),
      hit_ticks_(config.clock.cycles(config.hit_cycles)),
      tags_(config.cache, 1) {}

bool SharedCache::look_up(std::uint32_t line) {
  const bool hit = tags_.access(0, line);
  ++(hit ? statistics_.lookups.hits : statistics_.lookups.misses);
  return hit;
}

SharedCache::Hit SharedCache::hit_at(sim::Ticks arrival, sim::Ticks there) {
  const sim::Ticks start = std::max(arrival, there - hit_ticks_);
  statistics_.waits.add(start - arrival);
  return {start, sim::add_ticks(start, hit_ticks_)};
}

std::optional<SharedCache::Hit> SharedCache::read(Address address, sim::Ticks arrival) {
  const std::uint32_t line = line_of(address);
  if (!look_up(line)) {
    return std::nullopt;
  }
  const auto coming = coming_.find(line);
  return hit_at(arrival, coming == coming_.end() ? arrival : coming->second.ready);
}

void SharedCache::fill(Address address, sim::Ticks arrival, sim::Ticks ready) {
  note_coming(line_of(address), {ready, no_port}, arrival);
}

SharedCache::LateLook SharedCache::read_late(std::uint32_t port, Address address, sim::Ticks arrival) {
  const std::uint32_t line = line_of(address);
  if (!look_up(line)) {
    note_coming(line, {not_told, port}, arrival);
    return {.miss = true, .hit = std::nullopt};
  }
  const auto coming = coming_.find(line);
  if (coming != coming_.end() && coming->second.port != no_port) {
    waiting_[coming->second.port].push_back({port, arrival});
    return {};
  }
  return {.miss = false, .hit = hit_at(arrival, coming == coming_.end() ? arrival : coming->second.ready)};
}

std::vector<SharedCache::LateHit> SharedCache::tell(std::uint32_t port, Address address, sim::Ticks ready) {
  // The line may have been replaced and missed again: then it comes with a later miss.
  const auto coming = coming_.find(line_of(address));
  if (coming != coming_.end() && coming->second.port == port) {
    coming->second = {ready, no_port};
  }
  std::vector<LateHit> hits;
  if (const auto waiting = waiting_.extract(port)) {
    for (const Waiting& read : waiting.mapped()) {
      hits.push_back({read.port, read.arrival, hit_at(read.arrival, ready)});
    }
  }
  return hits;
}

void SharedCache::note_coming(std::uint32_t line, const Coming& coming, sim::Ticks now) {
  if (coming_.size() >= most_coming_) {
    std::erase_if(coming_, [&](const auto& entry) { return entry.second.ready <= now; });
    most_coming_ = std::max<std::size_t>(64, 2 * coming_.size());
  }
  coming_.insert_or_assign(line, coming);
}

}  // namespace marti::memory
