// The lines brought in by each of many equal caches that never have to replace one.
#pragma once

#include <cstddef>
#include <cstdint>

#include "memory/cache_config.h"
#include "sim/large_pages.h"

namespace marti::memory {

/// Whether a cache of this shape holds `lines` consecutive lines, the first being number 0, without ever
/// replacing one: no set then gets more lines than it has ways, and since empty ways are filled first, that
/// holds for every replacement.
[[nodiscard]] constexpr bool holds_all(const CacheShape& shape, std::uint64_t lines) {
  return (lines + shape.sets - 1) / shape.sets <= shape.ways;
}

/// A bit for each line of each cache; gives the same hits and misses as a tag store for such caches.
class LineSet {
 public:
  LineSet(std::uint64_t lines, std::uint32_t caches)
      : words_((lines + 63) / 64), bits_(static_cast<std::size_t>(words_) * caches) {}

  /// Looks `line` up in `cache`; true when it holds it. Brings a missing line in.
  [[gnu::always_inline]] bool access(std::uint32_t cache, std::uint32_t line) {
    std::uint64_t& word = bits_[cache * words_ + line / 64];
    const std::uint64_t bit = std::uint64_t{1} << (line % 64);
    const bool there = (word & bit) != 0;
    word |= bit;
    return there;
  }

 private:
  std::uint64_t words_;  // for each cache
  sim::ZeroedTable<std::uint64_t> bits_;
};

}  // namespace marti::memory
