// The caches of nodes that count more than hits and misses, for every kind of cache: slower and general. Hits
// and misses are those of node_caches.h.
#pragma once

#include <memory>
#include <vector>

#include "memory/tag_array.h"
#include "processors/cache_counting.h"
#include "processors/node_caches.h"
#include "processors/replay_input.h"

namespace marti::processors {

/// `Present` is false for nodes without a cache.
template <bool Present>
class CountedCaches {
  struct State;

 public:
  static constexpr bool present = Present;
  static constexpr bool by_kind = true;
  static constexpr bool counted = true;

  explicit CountedCaches(const ReplayInput& input) : state_(std::make_unique<State>(input)) {}

  class View {
   public:
    View(CountedCaches& caches, std::uint32_t node) : state_(*caches.state_), node_(node) {}
    bool access(memory::RecordKind kind, std::uint32_t line, Origin origin = {}) const {
      const std::size_t cache =
          state_.tags.size() > 1 ? split_cache_of[static_cast<std::size_t>(kind)] : std::size_t{0};
      const bool hit = Present && state_.tags[cache].access(node_, line);
      state_.counting.refer(node_, cache, kind, line, origin, hit);
      return hit;
    }

   private:
    State& state_;
    std::uint32_t node_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return {*this, node}; }

  [[nodiscard]] CacheCounting& counting() const { return state_->counting; }

 private:
  struct State {
    explicit State(const ReplayInput& input)
        : counting(input.config, input.layout.end() / input.config.reference_bytes() + 1) {
      const NodeCacheConfig& config = input.config.cache;
      if (config.organisation == CacheOrganisation::unified) {
        tags.emplace_back(config.cache, input.config.all_nodes());
      } else if (config.organisation == CacheOrganisation::split) {
        for (const std::uint64_t size : config.split_sizes) {
          memory::CacheConfig part = config.cache;
          part.size = size;
          tags.emplace_back(part, input.config.all_nodes());
        }
      }
    }
    std::vector<memory::TagArray> tags;  // of the unified cache, or of the split ones
    CacheCounting counting;
  };

  std::unique_ptr<State> state_;
};

}  // namespace marti::processors
