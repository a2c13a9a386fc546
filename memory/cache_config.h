// The configuration of a cache.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "sim/mix.h"

namespace marti::memory {

/// plru: tree-PLRU, a tree of bits over the ways of a set (plru_trees.h).
enum class Replacement : std::uint8_t { lru, fifo, random, plru };
inline constexpr std::array<std::string_view, 4> replacement_names = {"lru", "fifo", "random", "plru"};

/// The size that means "one set": as many ways as there are lines.
inline constexpr std::uint32_t full_ways = 0;

/// Geometry of one cache. Only tags are simulated, not data: reads allocate, writes bypass the cache.
struct CacheConfig {
  std::uint64_t size = 16 * 1024;  ///< bytes; a whole number of sets of lines
  std::uint32_t line = 32;         ///< bytes; a power of two
  std::uint32_t ways = 4;  ///< lines in a set; full_ways for a fully associative cache; plru: a power of two
  Replacement replacement = Replacement::lru;
  std::uint64_t seed = 1;  ///< of random replacement
};

/// Sets and ways of a checked cache. Sets need not be a power of two: the set of a line is its number
/// modulo the number of sets.
struct CacheShape {
  std::uint32_t sets = 0;
  std::uint32_t ways = 0;
  std::uint32_t line_shift = 0;

  [[nodiscard]] std::uint64_t lines() const { return std::uint64_t{sets} * ways; }
};

/// The most lines one cache may have.
inline constexpr std::uint64_t most_lines = std::uint64_t{1} << 28U;

/// Throws UserError with the reason when no such cache can be built.
[[nodiscard]] CacheShape shape_of(const CacheConfig& config);

/// The state of random replacement: one stream of victims for each set, which depends only on seed and set.
/// Each call gives the next way, uniform over 0 .. ways - 1 up to 2^-32 (SplitMix64, Steele et al. 2014,
/// scaled by the high half of a product).
class VictimStream {
 public:
  VictimStream(std::uint64_t seed, std::uint64_t set) : state_(seed + set * 0xd1342543de82ef95ULL) {}
  std::uint32_t next(std::uint32_t ways) {
    state_ += sim::mix_step;
    return static_cast<std::uint32_t>(((sim::mixed_bits(state_) >> 32U) * ways) >> 32U);
  }

 private:
  std::uint64_t state_;
};

}  // namespace marti::memory
