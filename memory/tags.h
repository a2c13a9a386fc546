// Chooses the tag store for a cache: turns a configuration at run time into one of the compiled look-ups.
#pragma once

#include "memory/hashed_tags.h"
#include "memory/policies.h"
#include "memory/quad_tags.h"
#include "memory/set_tags.h"

namespace marti::memory {

/// Above this many ways a hash table is quicker than a linear search.
inline constexpr std::uint32_t most_searched_ways = 16;

/// Calls `use.template operator()<Tags>()` with the tag store type for a replacement policy and shape.
template <class Use>
decltype(auto) with_tag_store(Replacement replacement, const CacheShape& shape, Use&& use) {
  const bool hashed = shape.ways > most_searched_ways;
  if (replacement != Replacement::lru) {
    return with_policy(replacement, [&]<Replacement Policy>() -> decltype(auto) {
      return hashed ? use.template operator()<HashedTags<Policy>>()
                    : use.template operator()<SetTags<Policy, 0>>();
    });
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
