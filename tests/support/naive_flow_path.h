// A second way to find the critical path of machines in which rays move: everything that a second model of
// such a machine does is kept, and the path is sought back from the end. Messages must not wait for links.
#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include "processors/path/path_piece.h"
#include "sim/error.h"

namespace marti::test {

/// A stretch of a path. What a node does by itself is all `traversal`.
struct NaivePiece {
  sim::Ticks from = 0;
  sim::Ticks to = 0;
  std::uint32_t node = 0;
  processors::path::PathKind kind = processors::path::PathKind::traversal;
  friend bool operator==(const NaivePiece&, const NaivePiece&) = default;
};

inline NaivePiece naive_piece(const processors::path::PathPiece& piece) {
  using processors::path::PathKind;
  return {piece.from, piece.to, piece.owner.node,
          processors::path::is_own_work(piece.kind) ? PathKind::traversal : piece.kind};
}

/// Adds a piece that ends where the last one begins; pieces of one kind and node become one.
inline void add_piece(std::vector<NaivePiece>& path, const NaivePiece& piece) {
  if (piece.from == piece.to) {
    return;
  }
  if (!path.empty() && path.back().node == piece.node && path.back().kind == piece.kind) {
    path.back().from = piece.from;
  } else {
    path.push_back(piece);
  }
}

/// Who does something is a node, or the host's link into a cluster: number of nodes + cluster.
class NaiveFlowPath {
 public:
  /// Node, or the host for a camera ray that node `piece.node` gets, was at work.
  void worked(std::uint32_t who, const NaivePiece& piece) { stretches_.push_back({who, who, piece}); }
  /// `who` has waited until `at` for something that `by` has freed.
  void let_go(std::uint32_t who, std::uint32_t by, sim::Ticks at) {
    stretches_.push_back({who, by, {at, at}});
  }
  /// `who` has waited until its arrival for a message that was sent by `by` or, set aside, let go by it.
  void took(std::uint32_t who, std::uint32_t by, const NaivePiece& message) {
    stretches_.push_back({who, by, message});
  }
  void contributed(std::uint32_t by, sim::Ticks sent, sim::Ticks arrival) {
    contributions_.push_back({by, by, {sent, arrival, by, processors::path::PathKind::network}});
  }
  void finished(std::uint32_t node, sim::Ticks at) { finished_.emplace_back(at, node); }

  /// The path, the last piece first.
  [[nodiscard]] std::vector<NaivePiece> path(sim::Ticks end) const {
    std::vector<NaivePiece> path;
    std::uint32_t who = 0;
    sim::Ticks at = end;
    std::uint32_t lowest = none;
    for (const auto& [time, node] : finished_) {
      lowest = time == end ? std::min(lowest, node) : lowest;
    }
    const auto go_back = [&](const Stretch& stretch) {
      add_piece(path, stretch.piece);
      at = stretch.piece.from;
      who = stretch.by;
    };
    if (lowest != none || end == 0) {
      who = lowest;
    } else {
      sim::ensure(!contributions_.empty(), "nothing ends a frame");
      go_back(*std::find_if(contributions_.begin(), contributions_.end(),
                            [&](const Stretch& last) { return last.piece.to == end; }));
    }
    while (at != 0) {
      go_back(ending(who, at));
    }
    return path;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  struct Stretch {
    std::uint32_t who;
    std::uint32_t by;  // whose turn it was before
    NaivePiece piece;
  };

  // What led to what `who` did at that time: its own work, or else what let it go on first.
  [[nodiscard]] const Stretch& ending(std::uint32_t who, sim::Ticks at) const {
    const Stretch* found = nullptr;
    for (const Stretch& stretch : stretches_) {
      if (stretch.who == who && stretch.piece.to == at) {
        if (stretch.by == who && stretch.piece.from < at) {
          return stretch;
        }
        found = found == nullptr ? &stretch : found;
      }
    }
    sim::ensure(found != nullptr, "nothing ends then");
    return *found;
  }

  std::vector<Stretch> stretches_;
  std::vector<Stretch> contributions_;
  std::vector<std::pair<sim::Ticks, std::uint32_t>> finished_;
};

}  // namespace marti::test
