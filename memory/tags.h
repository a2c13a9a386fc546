// Chooses the tag store for a cache: turns a configuration at run time into one of the compiled look-ups.
#pragma once

#include <utility>

#include "memory/hashed_tags.h"
#include "memory/quad_tags.h"
#include "memory/set_tags.h"

namespace marti::memory {

/// Above this many ways a hash table is quicker than a linear search.
inline constexpr std::uint32_t most_searched_ways = 16;

/// Calls `use.template operator()<Tags>()` with the tag store type for a replacement policy and shape.
template <class Use>
decltype(auto) with_tag_store(Replacement replacement, const CacheShape& shape, Use&& use) {
  const bool hashed = shape.ways > most_searched_ways;
  switch (replacement) {
    case Replacement::fifo:
      return hashed ? use.template operator()<HashedTags<Replacement::fifo>>()
                    : use.template operator()<SetTags<Replacement::fifo, 0>>();
    case Replacement::random:
      return hashed ? use.template operator()<HashedTags<Replacement::random>>()
                    : use.template operator()<SetTags<Replacement::random, 0>>();
    case Replacement::plru:
      return hashed ? use.template operator()<HashedTags<Replacement::plru>>()
                    : use.template operator()<SetTags<Replacement::plru, 0>>();
    case Replacement::lru:
      break;
  }
  switch (shape.ways) {
    case 1:
      return use.template operator()<SetTags<Replacement::lru, 1>>();
    case 2:
      return use.template operator()<SetTags<Replacement::lru, 2>>();
    case 4:
      return use.template operator()<QuadTags>();
    case 8:
      return use.template operator()<SetTags<Replacement::lru, 8>>();
    default:
      return hashed ? use.template operator()<HashedTags<Replacement::lru>>()
                    : use.template operator()<SetTags<Replacement::lru, 0>>();
  }
}

}  // namespace marti::memory
