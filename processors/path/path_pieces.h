// The chains of pieces of work that lead to what a machine is doing now.
//
// Each thing that is going on (a node's work, what a bus or bank did last, a write on its way) has a chain:
// the pieces of work of which each began when the one before it ended, from time 0 to the present. Chains are
// lists that share their beginnings, so the chain of whatever ends the frame is the critical path. A piece
// that no chain needs any more is removed, so what is kept are the chains that may still become the critical
// path, not all that ever happened.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "processors/walk/cause_observer.h"
#include "sim/memory_budget.h"
#include "sim/time.h"

namespace marti::processors {

/// What is done in a piece. Those up to messaging are the activities of these names.
enum class PathKind : std::uint8_t {
  traversal,
  intersection,
  shading,
  building,
  cache_access,
  switching,
  messaging,
  own_memory,    ///< a node's reads and writes of a memory that no other node uses
  transfer,      ///< over the bus, crossbar, ideal interconnect or network, and the beats of a home's memory
  shared_cache,  ///< hits in the cache before the banks
  bank_access,   ///< a bank or a home's memory at work for an access, until it can begin the next one
  dispatch,      ///< the host at work for a node's request
};
inline constexpr std::size_t path_kinds = 12;
inline constexpr std::array<std::string_view, path_kinds> path_kind_names = {
    "traversal", "intersection", "shading",  "building",     "cache_access", "switching",
    "messaging", "own_memory",   "transfer", "shared_cache", "bank_access",  "dispatch"};
/// Whether a node does this by itself.
[[nodiscard]] constexpr bool is_own_work(PathKind kind) { return kind <= PathKind::own_memory; }

/// For whom a piece is done.
struct PathOwner {
  std::uint32_t node = 0;
  LogPlace place;  ///< what the node had come to when it began, or asked for, the piece
};

/// A piece as it is read back.
struct PathPiece {
  sim::Ticks from = 0;
  sim::Ticks to = 0;
  PathOwner owner;
  PathKind kind = PathKind::traversal;

  /// Whether this piece goes on with what `before`, the piece before it, does: for the same node, both the
  /// node's own work or both of one kind.
  [[nodiscard]] bool goes_on_from(const PathPiece& before) const {
    return owner.node == before.owner.node &&
           (kind == before.kind || (is_own_work(kind) && is_own_work(before.kind)));
  }
};

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
  /// More pieces than fit the budget are refused with a KeyError.
  explicit PathPieces(const sim::MemoryBudget& budget) : budget_(budget) {}
  PathPieces(const PathPieces&) = delete;
  PathPieces& operator=(const PathPieces&) = delete;

  /// The chain with a further piece of `length`, at least 0; without length it is the same chain.
  [[nodiscard]] PathTip append(const PathTip& before, sim::Ticks length, const PathOwner& owner,
                               PathKind kind);
  /// Calls visit(piece) for the pieces of a chain, the last one first.
  template <class Visit>
  void each_from_the_end(const PathTip& tip, const Visit& visit) const;
  /// The largest number of pieces that were kept at the same time.
  [[nodiscard]] std::uint64_t most_kept() const { return made_; }

 private:
  friend class PathTip;
  struct Kept {
    sim::Ticks to = 0;
    std::uint32_t before = none;
    std::uint32_t uses = 0;  // tips and pieces that follow
    PathOwner owner;
    PathKind kind = PathKind::traversal;
  };
  static constexpr std::uint32_t none = 0xffffffffU;
  static constexpr unsigned block_bits = 15;
  static constexpr std::uint32_t block = 1U << block_bits;

  [[nodiscard]] Kept& at(std::uint32_t index) { return blocks_[index >> block_bits][index & (block - 1)]; }
  [[nodiscard]] const Kept& at(std::uint32_t index) const {
    return blocks_[index >> block_bits][index & (block - 1)];
  }
  std::uint32_t take_place();
  // One user of the piece less; removes those that have no user left.
  void leave(std::uint32_t index);

  sim::MemoryBudget budget_;
  std::vector<std::unique_ptr<Kept[]>> blocks_;
  std::uint32_t made_ = 0;
  std::uint32_t free_ = none;  // list of places, linked by `before`
};

template <class Visit>
void PathPieces::each_from_the_end(const PathTip& tip, const Visit& visit) const {
  for (std::uint32_t index = tip.pieces_ == nullptr ? none : tip.last_; index != none;) {
    const Kept& piece = at(index);
    const sim::Ticks from = piece.before == none ? 0 : at(piece.before).to;
    visit(PathPiece{from, piece.to, piece.owner, piece.kind});
    index = piece.before;
  }
}

}  // namespace marti::processors
