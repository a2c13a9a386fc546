#include "memory/cache.h"

#include "memory/set_tags.h"
#include "sim/error.h"

namespace marti::memory {

Cache::Cache(const CacheConfig& config) : shape_(shape_of(config)), tags_(config, 1) {}

Cache::Lines Cache::lines_of(Address address, std::uint64_t bytes) const {
  if (bytes == 0 || address > ~Address{0} - bytes) {
    throw sim::UserError("an access of 0 bytes or beyond the last address");
  }
  const Lines lines = {address >> shape_.line_shift, (address + bytes - 1) >> shape_.line_shift};
  if (lines.last >= no_line) {
    throw sim::UserError("an address beyond 2^32 - 1 cache lines");
  }
  return lines;
}

std::int64_t Cache::read(Address address, std::uint64_t bytes) {
  const Lines lines = lines_of(address, bytes);
  std::int64_t missed = 0;
  for (Address line = lines.first; line <= lines.last; ++line) {
    missed += tags_.access(0, static_cast<std::uint32_t>(line)) ? 0 : 1;
  }
  counters_.misses += missed;
  counters_.hits += static_cast<std::int64_t>(lines.last - lines.first + 1) - missed;
  return missed;
}

std::int64_t Cache::invalidate(Address address, std::uint64_t bytes) {
  const Lines lines = lines_of(address, bytes);
  std::int64_t removed = 0;
  for (Address line = lines.first; line <= lines.last; ++line) {
    removed += tags_.remove(0, static_cast<std::uint32_t>(line)) ? 1 : 0;
  }
  return removed;
}

}  // namespace marti::memory
