#include "memory/cache_config.h"

#include <bit>
#include <string>

#include "memory/policies.h"
#include "sim/error.h"

namespace marti::memory {

CacheShape shape_of(const CacheConfig& config) {
  if (!std::has_single_bit(config.line)) {
    throw sim::UserError("a cache line must be a power of two in bytes, not " + std::to_string(config.line));
  }
  if (config.size < config.line || config.size % config.line != 0) {
    throw sim::UserError("a cache of " + std::to_string(config.size) +
                         " bytes is not a whole number of lines of " + std::to_string(config.line) +
                         " bytes");
  }
  const std::uint64_t lines = config.size / config.line;
  if (lines > most_lines) {
    throw sim::UserError("a cache of " + std::to_string(lines) + " lines; at most 2^28 are possible");
  }
  const std::uint64_t ways = config.ways == full_ways ? lines : config.ways;
  if (ways > lines || lines % ways != 0) {
    throw sim::UserError("a cache of " + std::to_string(lines) + " lines cannot be divided into sets of " +
                         std::to_string(ways) + " ways");
  }
  with_policy(config.replacement, [ways]<Replacement Policy>() { VictimsOf<Policy>::check(ways); });
  return {static_cast<std::uint32_t>(lines / ways), static_cast<std::uint32_t>(ways),
          static_cast<std::uint32_t>(std::countr_zero(config.line))};
}

}  // namespace marti::memory
