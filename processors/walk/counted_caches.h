// The caches of nodes that count more than hits and misses. One class for every kind of cache, slower than
// those of node_caches.h; hits and misses are the same.
#pragma once

#include <memory>

#include "processors/walk/cache_counting.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/replay_input.h"

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
      const AnyCaches::View caches = state_.caches.view(node_);
      const bool hit = Present && caches.access(kind, line);
      state_.counting.refer(node_, caches.cache_of(kind), kind, line, origin, hit);
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
        : caches(input.config),
          counting(input.config, input.layout.end() / input.config.reference_bytes() + 1) {}
    AnyCaches caches;
    CacheCounting counting;
  };

  std::unique_ptr<State> state_;
};

}  // namespace marti::processors
