// The private caches of nodes with contexts or prefetches: tags as without them, and in addition the lines
// that are still on their way from memory.
//
// A line on its way is known by the transaction that brings it. Without a second level, a line that the first
// level has pushed out before it came is fetched again. A private second level serves all first-level caches
// of its node and receives the data too. So with one, a reference that misses its first-level cache while the
// line is on its way to the node, for any of its caches, waits for that transaction and starts no other.
#pragma once

#include <type_traits>
#include <utility>

#include "processors/walk/cache_counting.h"
#include "processors/walk/context_result.h"
#include "processors/walk/lines_under_way.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/prefetch_lines.h"

namespace marti::processors::walk {

/// Base classes of caches: CountedMark, with the member `counted`, of those that count, and UncountedMark.
struct CountedMark {
  static constexpr bool counted = true;
};
struct UncountedMark {};

/// `Caches` is one of node_caches.h, or CountedCaches.
template <class Caches>
class GuardedCaches : public std::conditional_t<are_counted<Caches>, CountedMark, UncountedMark> {
 public:
  static constexpr bool present = Caches::present;
  static constexpr bool by_kind = Caches::by_kind;
  static constexpr bool guarded = true;

  GuardedCaches(const ReplayInput& input, Caches caches)
      : caches_(std::move(caches)),
        prefetch_(input.config.prefetch),
        second_level_(input.config.l2.sharing == machine::SecondLevel::private_caches),
        targets_(input, input.config.cache.cache.line),
        lines_(present ? input.config.all_nodes() : 0),
        counts_(input.config.all_nodes()) {}

  class View {
   public:
    View(GuardedCaches& all, std::uint32_t node) : all_(all), node_(node), tags_(all.caches_.view(node)) {}

    /// Returns what UnifiedCaches::View::access does; `origin` is given where references are counted.
    template <class... Origins>
    bool access(memory::RecordKind kind, std::uint32_t line, Origins... origin) const {
      const bool hit = tags_.access(kind, line, origin...);
      if constexpr (present) {
        if (all_.lines_[node_].unmark(key(kind, line))) {
          ++(hit ? counts().useful : counts().useless);
        }
      }
      return hit;
    }
    /// As access(), but a line that is missing is not brought in.
    template <class... Origins>
    bool touch(memory::RecordKind kind, std::uint32_t line, Origins... origin) const {
      const bool hit = tags_.touch(kind, line, origin...);
      if constexpr (present) {
        counts().useful += hit && all_.lines_[node_].unmark(key(kind, line)) ? 1 : 0;
      }
      return hit;
    }
    /// Removes a line, whatever kinds of record it holds; returns how many copies there were.
    [[nodiscard]] std::int64_t remove(std::uint32_t line) const { return tags_.remove(line); }
    [[nodiscard]] bool holds(memory::RecordKind kind, std::uint32_t line) const {
      return tags_.holds(kind, line);
    }
    /// The node's transaction that brings a line, for which a reference at `time` has to wait; else
    /// LinesUnderWay::none.
    [[nodiscard]] std::uint32_t awaits(memory::RecordKind kind, std::uint32_t line, sim::Ticks time) const {
      if constexpr (present) {
        LinesUnderWay& lines = all_.lines_[node_];
        const std::uint32_t own = lines.find(key(kind, line), time);
        if (tags_.holds(kind, line) || (own != LinesUnderWay::none && all_.second_level_)) {
          return own;
        }
        if (all_.second_level_) {
          return lines.find_in_any(line, time);
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
    /// Whether the line is there or on its way, so that it is not prefetched.
    [[nodiscard]] bool has(memory::RecordKind kind, std::uint32_t line, sim::Ticks time) const {
      return tags_.holds(kind, line) || awaits(kind, line, time) != LinesUnderWay::none;
    }
    /// Starts to fetch a line by transaction `slot`. prefetch() is for a line that the cache does not hold
    /// and brings its tag in; begin() is for a line whose tag is in already, as after a miss.
    void prefetch(memory::RecordKind kind, std::uint32_t line, std::uint32_t slot, sim::Ticks time) const {
      if constexpr (are_counted<Caches>) {
        tags_.bring_in(kind, line);
      } else {
        (void)tags_.access(kind, line);
      }
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
  /// Of caches that count.
  [[nodiscard]] decltype(auto) counting() const { return caches_.counting(); }
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
  machine::PrefetchConfig prefetch_;
  bool second_level_;  // each node has one of its own
  PrefetchLines targets_;
  std::vector<LinesUnderWay> lines_;
  std::vector<ContextCounts> counts_;
};

}  // namespace marti::processors::walk
