// The chains of pieces of work that lead to what a machine is doing now.
//
// Each thing that is going on (a node's work, what a bus or bank did last, a write on its way) has a chain:
// the pieces of work of which each began when the one before it ended, from time 0 to the present. Chains are
// lists that share their beginnings, so the chain of whatever ends the frame is the critical path. A piece
// that no chain needs any more is removed. Those that are left form a tree; now and then the pieces between
// two of its branchings are folded into their sum, so that what is kept depends on how many things are going
// on, and not on how long the frame is.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "processors/path/path_piece.h"
#include "processors/path/path_sum.h"
#include "sim/error.h"
#include "sim/memory_budget.h"
#include "sim/time.h"

namespace marti::processors::path {

class PathPieces;

/// The end of a chain. A copy refers to the same chain; the pieces exist as long as a tip needs them.
class PathTip {
 public:
  PathTip() = default;  ///< the chain without pieces, which ends at time 0
  PathTip(const PathTip& other);
  PathTip(PathTip&& other) noexcept;
  PathTip& operator=(PathTip other) noexcept;
  ~PathTip();

  /// When the last piece ends.
  [[nodiscard]] sim::Ticks end() const { return end_; }

 private:
  friend class PathPieces;
  PathTip(PathPieces& pieces, std::uint32_t last, sim::Ticks end)
      : pieces_(&pieces), end_(end), last_(last) {}

  PathPieces* pieces_ = nullptr;  // null: no pieces
  sim::Ticks end_ = 0;
  std::uint32_t last_ = 0;
};

/// What a tenure follows that is wanted by `asking` from its end on, of a resource whose last tenure is
/// `holder`: the holder if it keeps the resource beyond that time, else what asks.
[[nodiscard]] inline const PathTip& later_of(const PathTip& asking, const PathTip& holder) {
  return holder.end() > asking.end() ? holder : asking;
}

/// All pieces. It must outlive their tips.
class PathPieces {
 public:
  static constexpr std::uint32_t usual_fold = 1U << 14U;
  static constexpr std::uint32_t no_fold = 0xffffffffU;

  /// More pieces than fit the budget are refused with a KeyError. Pieces are folded whenever so many are
  /// there; with no_fold never.
  explicit PathPieces(const sim::MemoryBudget& budget, std::uint32_t fold_from = usual_fold)
      : budget_(budget), fold_from_(fold_from), fold_at_(fold_from) {}
  PathPieces(const PathPieces&) = delete;
  PathPieces& operator=(const PathPieces&) = delete;

  /// The chain with a further piece of `length`, at least 0; without length it is the same chain.
  [[nodiscard]] PathTip append(const PathTip& before, sim::Ticks length, const PathOwner& owner,
                               PathKind kind);
  /// Takes from the budget what the things that are going on take; refused like too many pieces.
  void take(std::uint64_t bytes);
  /// Needed to fold; it must outlive the last call of append().
  void set_levels(LogLevels& levels) { levels_ = &levels; }
  /// Calls visit(piece) for the pieces of a chain, the last one first. Only where pieces are never folded.
  template <class Visit>
  void each_from_the_end(const PathTip& tip, const Visit& visit) const;
  /// The sum of the pieces of a chain.
  [[nodiscard]] PathSum sum_of(const PathTip& tip, LogLevels& levels) const;
  /// The largest number of pieces that were kept at the same time; those that are folded into one count as
  /// one.
  [[nodiscard]] std::uint64_t most_kept() const { return made_; }

 private:
  friend class PathTip;
  static constexpr std::uint32_t none = 0xffffffffU;
  struct Kept {
    sim::Ticks to = 0;
    std::uint32_t before = none;
    std::uint32_t uses = 0;  // tips and pieces that follow
    PathOwner owner;
    std::uint32_t sum = none;  // of the pieces that were folded into this one
    PathKind kind = PathKind::traversal;
  };
  static constexpr unsigned block_bits = 14;
  static constexpr std::uint32_t block = 1U << block_bits;

  [[nodiscard]] Kept& at(std::uint32_t index) { return blocks_[index >> block_bits][index & (block - 1)]; }
  [[nodiscard]] const Kept& at(std::uint32_t index) const {
    return blocks_[index >> block_bits][index & (block - 1)];
  }
  [[nodiscard]] PathPiece piece_at(std::uint32_t index) const;
  void prepend_to(PathSum& sum, std::uint32_t index, LogLevels& levels) const;
  std::uint32_t take_place();
  void free_place(std::uint32_t index);
  // Makes `sum` that of the piece.
  void keep_sum(Kept& piece, PathSum sum);
  // Refuses so many blocks if they do not fit the budget beside the sums.
  void require(std::size_t blocks) const;
  // Folds each run of pieces of which each is needed only by the one behind it.
  void fold();
  // One user of the piece less; removes those that have no user left.
  void leave(std::uint32_t index);

  sim::MemoryBudget budget_;
  std::vector<std::unique_ptr<Kept[]>> blocks_;
  std::uint32_t made_ = 0;
  std::uint32_t in_use_ = 0;
  std::uint32_t free_ = none;  // list of places, linked by `before`
  std::uint32_t fold_from_;
  std::uint32_t fold_at_;
  LogLevels* levels_ = nullptr;
  std::vector<PathSum> sums_;
  std::uint64_t sum_bytes_ = 0;  // that are allocated for what is in sums_
  // Entries of sums_ that are not in use. It has room for all of them, because a tip's destructor may add to
  // it and must not throw.
  std::vector<std::uint32_t> free_sums_;
};

template <class Visit>
void PathPieces::each_from_the_end(const PathTip& tip, const Visit& visit) const {
  for (std::uint32_t index = tip.pieces_ == nullptr ? none : tip.last_; index != none;) {
    sim::ensure(at(index).sum == none, "the pieces of a path are gone");
    visit(piece_at(index));
    index = at(index).before;
  }
}

}  // namespace marti::processors::path
