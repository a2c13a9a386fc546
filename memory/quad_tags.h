// Tags of 4-way LRU caches: all four are compared at once, and their recency order is kept as a number. The
// commonest cache of the field thus has a look-up without a loop or an unpredictable branch.
#pragma once

#include <bit>
#include <cstdint>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "memory/cache_config.h"
#include "memory/lru_state.h"
#include "memory/set_tags.h"
#include "sim/large_pages.h"

namespace marti::memory {

class QuadTags {
 public:
  QuadTags(const CacheShape& shape, std::uint32_t caches, std::uint64_t /*seed*/)
      : index_(shape.sets),
        sets_(shape.sets),
        sets_of_caches_(std::size_t{caches} * shape.sets),
        states_(sets_of_caches_.size()) {}

  // The complements of the lines' numbers, so that empty ways, no_line, are 0.
  struct alignas(16) Set {
    std::uint32_t tags[4];
  };

  /// One of the caches, with everything that a look-up needs in registers.
  class View {
   public:
    View(const SetIndex& index, Set* sets, std::uint16_t* states)
        : index_(index), sets_(sets), states_(states) {}

    /// As SetTags::View::access.
    [[gnu::always_inline]] bool access(std::uint32_t line) const {
      const std::size_t at = index_(line);
      const std::uint32_t match = ways_that_hold(sets_[at], line);
      const std::uint32_t state = states_[at];
      states_[at] = lru_states.next[state + match];
      const bool hit = match != 0;
      if (!hit) [[unlikely]] {
        sets_[at].tags[lru_states.victim[state / LruStates::matches]] = ~line;
      }
      return hit;
    }
    /// As SetTags::View::touch.
    [[gnu::always_inline]] bool touch(std::uint32_t line) const {
      const std::size_t at = index_(line);
      const std::uint32_t match = ways_that_hold(sets_[at], line);
      if (match != 0) [[likely]] {
        states_[at] = lru_states.next[states_[at] + match];
      }
      return match != 0;
    }
    /// As SetTags::View::holds.
    [[nodiscard]] bool holds(std::uint32_t line) const {
      return ways_that_hold(sets_[index_(line)], line) != 0;
    }
    /// As SetTags::View::remove.
    bool remove(std::uint32_t line) const {
      const std::size_t at = index_(line);
      const std::uint32_t match = ways_that_hold(sets_[at], line);
      if (match == 0) {
        return false;
      }
      const auto way = static_cast<std::uint32_t>(std::countr_zero(match));
      sets_[at].tags[way] = ~no_line;
      states_[at] = lru_states.emptied[states_[at] / LruStates::matches * LruStates::ways + way];
      return true;
    }

   private:
    SetIndex index_;
    Set* sets_;
    std::uint16_t* states_;
  };

  [[nodiscard]] View view(std::uint32_t cache) {
    const std::size_t first = std::size_t{cache} * sets_;
    return {index_, sets_of_caches_.data() + first, states_.data() + first};
  }

 private:
  // One bit a way.
  static std::uint32_t ways_that_hold(const Set& set, std::uint32_t line) {
    const std::uint32_t tag = ~line;
#ifdef __SSE2__
    const __m128i tags = _mm_load_si128(reinterpret_cast<const __m128i*>(set.tags));
    const __m128i equal = _mm_cmpeq_epi32(tags, _mm_set1_epi32(static_cast<int>(tag)));
    return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(equal)));
#else
    return (set.tags[0] == tag ? 1U : 0U) | (set.tags[1] == tag ? 2U : 0U) | (set.tags[2] == tag ? 4U : 0U) |
           (set.tags[3] == tag ? 8U : 0U);
#endif
  }

  SetIndex index_;
  std::uint32_t sets_;
  sim::ZeroedTable<Set> sets_of_caches_;
  sim::ZeroedTable<std::uint16_t> states_;  // of LruStates, one for each set
};

}  // namespace marti::memory
