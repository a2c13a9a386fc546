// What pieces that follow each other add up to.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "processors/path/log_levels.h"
#include "processors/path/path_piece.h"
#include "sim/time.h"

namespace marti::processors::path {

/// Of a tree level: the traversal time of its nodes' visits, and the time of transfers, bank accesses and
/// hits of a shared cache that the steps at its nodes asked for.
struct PathLevel {
  sim::Ticks traversal = 0;
  sim::Ticks reads = 0;
};

class PathSum {
 public:
  /// Adds what comes before all that was added so far.
  void prepend(const PathPiece& piece, LogLevels& levels);
  void prepend(const PathSum& before);

  [[nodiscard]] const std::array<sim::Ticks, path_kinds>& time() const { return time_; }
  /// By node, ascending; those without a piece are left out.
  [[nodiscard]] const std::vector<std::pair<std::uint32_t, sim::Ticks>>& nodes() const { return nodes_; }
  /// The root's level is first.
  [[nodiscard]] const std::vector<PathLevel>& levels() const { return levels_; }
  /// Stretches as PathPiece::goes_on_from() divides them.
  [[nodiscard]] std::int64_t pieces() const { return pieces_; }
  [[nodiscard]] std::int64_t node_changes() const { return node_changes_; }
  /// Host bytes that it has allocated.
  [[nodiscard]] std::size_t bytes() const {
    return nodes_.capacity() * sizeof(nodes_[0]) + levels_.capacity() * sizeof(PathLevel);
  }

 private:
  // Joins the first piece so far to `last`, the last one of what comes before it.
  void join(const PathPiece& last);
  sim::Ticks& time_of(std::uint32_t node);
  PathLevel& level_of(std::uint32_t level);

  std::array<sim::Ticks, path_kinds> time_{};
  std::vector<std::pair<std::uint32_t, sim::Ticks>> nodes_;
  std::vector<PathLevel> levels_;
  std::int64_t pieces_ = 0;  // 0: nothing was added
  std::int64_t node_changes_ = 0;
  PathPiece first_;
  PathPiece last_;
};

}  // namespace marti::processors::path
