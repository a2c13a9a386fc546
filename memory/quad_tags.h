// Tags of 4-way LRU caches: all four compared at once, and the recency order kept beside them as a number.
// The commonest cache of the field gets the one look-up without a loop or an unpredictable branch.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "memory/cache_config.h"
#include "memory/lru_state.h"
#include "memory/set_tags.h"

namespace marti::memory {

class QuadTags {
 public:
  QuadTags(const CacheShape& shape, std::uint32_t caches, std::uint64_t /*seed*/)
      : index_(shape.sets), sets_(shape.sets), sets_of_caches_(std::size_t{caches} * shape.sets) {}

  /// As SetTags::access.
  [[gnu::always_inline]] bool access(std::uint32_t cache, std::uint32_t line) {
    Set& set = sets_of_caches_[std::size_t{cache} * sets_ + index_(line)];
    const std::uint32_t match = ways_that_hold(set, line);
    if (match != 0) [[likely]] {
      set.state = lru_states<4>.after_use[set.state][static_cast<std::uint32_t>(std::countr_zero(match))];
      return true;
    }
    replace(set, line);
    return false;
  }

 private:
  struct Set {
    std::uint32_t tags[4] = {no_line, no_line, no_line, no_line};
    std::uint32_t state = 0;
  };

  // One bit a way.
  static std::uint32_t ways_that_hold(const Set& set, std::uint32_t line) {
#ifdef __SSE2__
    const __m128i tags = _mm_loadu_si128(reinterpret_cast<const __m128i*>(set.tags));
    const __m128i equal = _mm_cmpeq_epi32(tags, _mm_set1_epi32(static_cast<int>(line)));
    return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(equal)));
#else
    return (set.tags[0] == line ? 1U : 0U) | (set.tags[1] == line ? 2U : 0U) |
           (set.tags[2] == line ? 4U : 0U) | (set.tags[3] == line ? 8U : 0U);
#endif
  }

  static void replace(Set& set, std::uint32_t line) {
    const std::uint32_t way = lru_states<4>.victim[set.state];
    set.tags[way] = line;
    set.state = lru_states<4>.after_use[set.state][way];
  }

  SetIndex index_;
  std::uint32_t sets_;
  std::vector<Set> sets_of_caches_;
};

}  // namespace marti::memory
