// The configuration of a cache.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace marti::memory {

/// plru: tree-PLRU, a tree of bits over the ways of a set (plru_trees.h); srrip: counters that say how soon a
/// line is expected to be used again (rrip_counters.h).
enum class Replacement : std::uint8_t { lru, fifo, random, plru, srrip };
inline constexpr std::array<std::string_view, 5> replacement_names = {"lru", "fifo", "random", "plru",
                                                                      "srrip"};

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

}  // namespace marti::memory
