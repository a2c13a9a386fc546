// The second-level cache of a machine, as values.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "memory/cache_config.h"
#include "sim/time.h"

namespace marti::processors::machine {

/// private_caches: each node has one behind its first-level cache or caches. shared: each cluster has one on
/// the memory's side of the interconnect.
enum class SecondLevel : std::uint8_t { none, private_caches, shared };
inline constexpr std::array<std::string_view, 3> second_level_names = {"none", "private", "shared"};

struct SecondLevelConfig {
  SecondLevel sharing = SecondLevel::none;
  /// `line` is ignored: the first level's is used, or without a first level the interleave of the banks.
  memory::CacheConfig cache{.size = 256 * 1024, .line = 32, .ways = 8};
  /// Nothing: private, the node's clock; shared, the interconnect's.
  std::optional<sim::Clock> clock;
  std::int64_t hit_cycles = 4;
};

}  // namespace marti::processors::machine
