// Where a SIMT node's cycles go, and those of its lanes (docs/internals/rt-unit.md, Where the time of a node
// goes).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "processors/cost/accounting.h"
#include "processors/walk/simt_result.h"

namespace marti::processors::simt {

/// What a lane of a warp with a packet does, in the order of the first counters of SimtCounts.
enum class LaneState : std::uint8_t {
  shading,
  slot,
  unit,
  scheduler,
  cache,
  memory,
  box,
  primitive,
  held,
  empty
};

/// The cycles that a phase computes, which follow each other in this order.
struct ComputeCycles {
  std::int64_t traversal = 0;
  std::int64_t intersection = 0;
  std::int64_t shading = 0;

  [[nodiscard]] std::int64_t all() const { return traversal + intersection + shading; }
};

/// What the cycles of a node that neither computes nor looks up belong to, from the highest rank on.
enum class Quiet : std::uint8_t { memory, cache, testing, writing, dispatch, idle };

/// A slot on which a warp computes.
struct Slot {
  std::uint32_t warp = 0;
  std::int64_t taken = 0;  ///< the cycle in which it began
  ComputeCycles cycles;
};

class NodeTime {
 public:
  /// Adds `lanes` lanes to those in a state, or takes them away.
  void add_lanes(LaneState state, std::int64_t lanes) { lanes_[static_cast<std::size_t>(state)] += lanes; }
  void move_lanes(LaneState from, LaneState to, std::int64_t lanes) {
    add_lanes(from, -lanes);
    add_lanes(to, lanes);
  }
  /// The first successful look-up of the present cycle was for such a record.
  void looked_up(memory::RecordKind kind) {
    if (!looked_up_) {
      looked_up_ = kind;
    }
  }

  /// Adds the cycles from the last call's on to `cycle`, exclusive. `computing`: the slot that was taken
  /// first; null if none is. tested_first(): the activity of the test that ends first.
  template <class TestedFirst>
  void settle(std::int64_t cycle, const Slot* computing, Quiet quiet, std::int64_t warps_in_unit,
              std::int64_t lines, const TestedFirst& tested_first) {
    const std::int64_t span = cycle - from_;
    if (span == 0) {
      return;
    }
    for (std::size_t state = 0; state < walk::lane_states; ++state) {
      counts_.*lane_counters[state] += lanes_[state] * span;
    }
    counts_.cycles += span;
    counts_.unit_cycles += warps_in_unit * span;
    counts_.line_cycles += lines * span;
    if (computing != nullptr) {
      compute(*computing, cycle);
    } else {
      const bool looked = looked_up_.has_value();
      if (looked) {
        spend(activity_of(*looked_up_), 1);
      }
      if (span > (looked ? 1 : 0)) {
        const bool testing = quiet == Quiet::testing;
        spend(testing ? tested_first() : quiet_activities[static_cast<std::size_t>(quiet)],
              span - (looked ? 1 : 0));
      }
    }
    looked_up_.reset();
    from_ = cycle;
  }

  /// Cycles that follow each other, of one activity; kept only when somebody observes the node.
  struct Piece {
    cost::Activity activity = cost::Activity::idle;
    std::int64_t cycles = 0;
  };
  void observe() { observed_ = true; }
  [[nodiscard]] std::vector<Piece> take_pieces() { return std::exchange(pieces_, {}); }

  /// Cycles of memory stand under bank_access until they are divided.
  [[nodiscard]] const std::array<std::int64_t, cost::activities>& cycles() const { return cycles_; }
  [[nodiscard]] walk::SimtCounts& counts() { return counts_; }
  [[nodiscard]] const walk::SimtCounts& counts() const { return counts_; }

 private:
  using A = cost::Activity;
  static constexpr std::array quiet_activities = {A::bank_access,     A::cache_access,  A::traversal,
                                                  A::queue_full_wait, A::dispatch_wait, A::idle};
  static constexpr std::array<std::int64_t walk::SimtCounts::*, walk::lane_states> lane_counters = {
      &walk::SimtCounts::lanes_shading,   &walk::SimtCounts::lanes_slot,      &walk::SimtCounts::lanes_unit,
      &walk::SimtCounts::lanes_scheduler, &walk::SimtCounts::lanes_cache,     &walk::SimtCounts::lanes_memory,
      &walk::SimtCounts::lanes_box,       &walk::SimtCounts::lanes_primitive, &walk::SimtCounts::lanes_held,
      &walk::SimtCounts::lanes_empty};

  static A activity_of(memory::RecordKind kind) {
    switch (kind) {
      case memory::RecordKind::node:
      case memory::RecordKind::transform:
      case memory::RecordKind::list:
        return A::traversal;
      case memory::RecordKind::primitive:
        return A::intersection;
      default:
        return A::shading;
    }
  }
  void spend(A activity, std::int64_t cycles) {
    cycles_[static_cast<std::size_t>(activity)] += cycles;
    if (observed_ && cycles > 0) {
      pieces_.push_back({activity, cycles});
    }
  }

  // The part of the slot's computing from `from_` to `to`.
  void compute(const Slot& slot, std::int64_t to) {
    std::int64_t begin = slot.taken;
    const auto part = [&](A activity, std::int64_t cycles) {
      const std::int64_t end = begin + cycles;
      spend(activity, std::max<std::int64_t>(0, std::min(end, to) - std::max(begin, from_)));
      begin = end;
    };
    part(A::traversal, slot.cycles.traversal);
    part(A::intersection, slot.cycles.intersection);
    part(A::shading, slot.cycles.shading);
  }

  std::array<std::int64_t, cost::activities> cycles_{};
  std::array<std::int64_t, walk::lane_states> lanes_{};
  walk::SimtCounts counts_;
  std::int64_t from_ = 0;
  std::optional<memory::RecordKind> looked_up_;
  bool observed_ = false;
  std::vector<Piece> pieces_;
};

}  // namespace marti::processors::simt
