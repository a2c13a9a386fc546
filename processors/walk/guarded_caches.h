// The private caches of nodes with contexts or prefetches: tags as without them, and in addition the lines
// that are still on their way from memory.
#pragma once

#include <utility>

#include "processors/walk/context_result.h"
#include "processors/walk/lines_under_way.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/prefetch_lines.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h.
template <class Caches>
class GuardedCaches {
 public:
  static constexpr bool present = Caches::present;
  static constexpr bool by_kind = Caches::by_kind;
  static constexpr bool guarded = true;

  GuardedCaches(const ReplayInput& input, Caches caches)
      : caches_(std::move(caches)),
        prefetch_(input.config.prefetch),
        targets_(input, input.config.cache.cache.line),
        lines_(present ? input.config.all_nodes() : 0),
        counts_(input.config.all_nodes()) {}

  class View {
   public:
    View(GuardedCaches& all, std::uint32_t node) : all_(all), node_(node), tags_(all.caches_.view(node)) {}

    /// Returns what UnifiedCaches::View::access does.
    bool access(memory::RecordKind kind, std::uint32_t line) const {
      const bool hit = tags_.access(kind, line);
      if constexpr (present) {
        if (all_.lines_[node_].unmark(key(kind, line))) {
          ++(hit ? counts().useful : counts().useless);
        }
      }
      return hit;
    }
    /// The node's transaction that brings the line, when the line's tag is in the cache but its data have not
    /// arrived by `time`; else LinesUnderWay::none.
    [[nodiscard]] std::uint32_t awaits(memory::RecordKind kind, std::uint32_t line, sim::Ticks time) const {
      if constexpr (present) {
        const std::uint32_t slot = all_.lines_[node_].find(key(kind, line), time);
        if (slot != LinesUnderWay::none && tags_.holds(kind, line)) {
          return slot;
        }
      }
      return LinesUnderWay::none;
    }
    /// Whether a child's record of this branch is missing, so that reading the branch prefetches something.
    [[nodiscard]] bool wants_children(std::uint32_t branch) const {
      return present && all_.prefetch_.children &&
             !all_.targets_.each_child_line(
                 branch, [&](std::uint32_t line) { return tags_.holds(memory::RecordKind::node, line); });
    }
    [[nodiscard]] bool holds(memory::RecordKind kind, std::uint32_t line) const {
      return tags_.holds(kind, line);
    }
    /// Starts to fetch a line by transaction `slot`. prefetch() is for a line that the cache does not hold
    /// and brings its tag in; begin() is for a line whose tag is in already, as after a miss.
    void prefetch(memory::RecordKind kind, std::uint32_t line, std::uint32_t slot, sim::Ticks time) const {
      (void)tags_.access(kind, line);
      ++counts().issued;
      counts().useless += all_.lines_[node_].mark(key(kind, line)) ? 1 : 0;
      begin(kind, line, slot, time);
    }
    void begin(memory::RecordKind kind, std::uint32_t line, std::uint32_t slot, sim::Ticks time) const {
      all_.lines_[node_].begin(key(kind, line), slot, time);
    }
    void arrives(std::uint32_t slot, sim::Ticks done) const { all_.lines_[node_].arrives(slot, done); }
    [[nodiscard]] ContextCounts& counts() const { return all_.counts_[node_]; }

   private:
    [[nodiscard]] LinesUnderWay::Key key(memory::RecordKind kind, std::uint32_t line) const {
      return LinesUnderWay::Key{tags_.cache_of(kind)} << 32U | line;
    }

    GuardedCaches& all_;
    std::uint32_t node_;
    typename Caches::View tags_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return {*this, node}; }

  [[nodiscard]] const PrefetchLines& targets() const { return targets_; }
  /// What each node counted, after the run. Prefetched lines that were never referenced count as useless.
  [[nodiscard]] std::vector<ContextCounts> counts() const {
    std::vector<ContextCounts> counts = counts_;
    for (std::size_t node = 0; node < lines_.size(); ++node) {
      counts[node].useless += static_cast<std::int64_t>(lines_[node].unasked());
    }
    return counts;
  }

 private:
  Caches caches_;
  PrefetchConfig prefetch_;
  PrefetchLines targets_;
  std::vector<LinesUnderWay> lines_;
  std::vector<ContextCounts> counts_;
};

}  // namespace marti::processors
