// The private caches of all nodes, as the node's inner loop sees them: one call that says hit or miss.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "memory/record_kind.h"
#include "memory/tags.h"
#include "processors/machine_config.h"

namespace marti::processors {

/// Which of the split caches a record kind uses.
inline constexpr std::array<std::uint8_t, memory::record_kinds> split_cache_of = {0, 1, 2, 3, 3, 3};

/// One tag store for a unified cache.
template <class Tags>
class UnifiedCaches {
 public:
  static constexpr bool present = true;
  UnifiedCaches(const MachineConfig& config, const memory::CacheShape& shape)
      : tags_(shape, config.all_nodes(), config.cache.cache.seed) {}
  bool access(std::uint32_t node, memory::RecordKind /*kind*/, std::uint32_t line) {
    return tags_.access(node, line);
  }

 private:
  Tags tags_;
};

/// One tag store for each of the split caches.
template <class Tags>
class SplitCaches {
 public:
  static constexpr bool present = true;
  SplitCaches(const MachineConfig& config, const std::array<memory::CacheShape, split_caches>& shapes) {
    tags_.reserve(split_caches);
    for (const memory::CacheShape& shape : shapes) {
      tags_.emplace_back(shape, config.all_nodes(), config.cache.cache.seed);
    }
  }
  bool access(std::uint32_t node, memory::RecordKind kind, std::uint32_t line) {
    return tags_[split_cache_of[static_cast<std::size_t>(kind)]].access(node, line);
  }

 private:
  std::vector<Tags> tags_;
};

/// Nodes without a cache: every reference misses, and only its own bytes are moved.
struct NoCaches {
  static constexpr bool present = false;
  static bool access(std::uint32_t /*node*/, memory::RecordKind /*kind*/, std::uint32_t /*line*/) {
    return false;
  }
};

}  // namespace marti::processors
