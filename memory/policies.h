// All replacement policies.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "memory/cache_config.h"
#include "memory/plru_trees.h"
#include "memory/random_victims.h"
#include "memory/rrip_counters.h"
#include "memory/victims.h"

namespace marti::memory {

/// In the order of Replacement; LRU and FIFO keep lines in order.
using AllVictims = std::tuple<KeptInOrder, KeptInOrder, RandomVictims, PlruTrees, RripCounters>;
static_assert(std::tuple_size_v<AllVictims> == replacement_names.size());

/// The state of a policy (victims.h).
template <Replacement Policy>
using VictimsOf = std::tuple_element_t<static_cast<std::size_t>(Policy), AllVictims>;

/// Whether lines stay in the way that they were brought into.
template <Replacement Policy>
inline constexpr bool stays_in_way = !std::is_same_v<VictimsOf<Policy>, KeptInOrder>;

/// Calls `use.template operator()<Policy>()` with the policy `wanted`, as a constant of the compiler. All
/// calls must return one type.
template <class Use, std::size_t At = 0>
decltype(auto) with_policy(Replacement wanted, Use&& use) {
  constexpr auto policy = static_cast<Replacement>(At);
  if constexpr (At + 1 < replacement_names.size()) {
    if (wanted != policy) {
      return with_policy<Use, At + 1>(wanted, std::forward<Use>(use));
    }
  }
  return std::forward<Use>(use).template operator()<policy>();
}

}  // namespace marti::memory
