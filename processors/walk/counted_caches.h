// The caches of nodes that count more than hits and misses, or whose references are heard. One class for
// every kind of cache, slower than those of node_caches.h; hits and misses are the same.
#pragma once

#include <memory>

#include "processors/walk/cache_counting.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/observer.h"
#include "processors/walk/record_places.h"
#include "processors/walk/replay_input.h"

namespace marti::processors::walk {

/// Whether nodes have to have such caches.
[[nodiscard]] inline bool needs_counted_caches(const ReplayInput& input) {
  return input.config.count.any() || hears_references(input);
}

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
    bool access(memory::RecordKind kind, std::uint32_t line, const Use& use = {}) const {
      const AnyCaches::View caches = state_.caches.view(node_);
      const bool hit = Present && caches.access(kind, line);
      refer(kind, line, use, hit);
      return hit;
    }
    /// As access(), but a line that is missing is not brought in, and counted only when it is.
    bool touch(memory::RecordKind kind, std::uint32_t line, const Use& use) const {
      const AnyCaches::View caches = state_.caches.view(node_);
      const bool hit = Present && caches.touch(kind, line);
      if (hit) {
        refer(kind, line, use, true);
      }
      return hit;
    }
    /// Removes a line that another node has written; returns how many copies there were.
    std::int64_t remove(std::uint32_t line) const {
      return state_.caches.view(node_).remove_each(
          line, [&](std::size_t cache, bool held) { state_.counting.written(node_, cache, line, held); });
    }
    /// Brings in a line that is missing and that nobody has referred to: a prefetch.
    void bring_in(memory::RecordKind kind, std::uint32_t line) const {
      const AnyCaches::View caches = state_.caches.view(node_);
      (void)caches.access(kind, line);
      state_.counting.bring_in(node_, caches.cache_of(kind), line);
    }
    [[nodiscard]] bool holds(memory::RecordKind kind, std::uint32_t line) const {
      return Present && state_.caches.view(node_).holds(kind, line);
    }
    [[nodiscard]] std::size_t cache_of(memory::RecordKind kind) const {
      return state_.caches.view(node_).cache_of(kind);
    }

   private:
    void refer(memory::RecordKind kind, std::uint32_t line, const Use& use, bool hit) const {
      state_.counting.refer(node_, cache_of(kind), kind, line, use.origin, hit, use.own);
      if (state_.listener != nullptr) {
        state_.listener->referred({use.time, node_, use.at, use.bytes, false}, kind, hit);
      }
    }

    State& state_;
    std::uint32_t node_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return {*this, node}; }

  [[nodiscard]] CacheCounting& counting() const { return state_->counting; }

 private:
  struct State {
    explicit State(const ReplayInput& input)
        : caches(input.config),
          counting(input.config, memory_lines(input.config, input.layout, input.tree)),
          listener(hears_references(input) ? input.observer : nullptr) {}
    AnyCaches caches;
    CacheCounting counting;
    Observer* listener;  // null: nobody hears of references
  };

  std::unique_ptr<State> state_;
};

/// Returns make(caches) with the caches of a machine that counts.
template <class Make>
auto with_counted_caches(const ReplayInput& input, const Make& make) {
  return input.config.cache.organisation == machine::CacheOrganisation::none
             ? make(CountedCaches<false>(input))
             : make(CountedCaches<true>(input));
}

}  // namespace marti::processors::walk
