// The critical path of a frame, added up.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "processors/path/path_pieces.h"
#include "sim/time.h"

namespace marti::processors::path {

/// A chain of pieces of work from 0 to the end of the frame, each beginning when the one before it ends.
struct CriticalPath {
  sim::Ticks end = 0;                         ///< the frame time; the sum of `time`, and of `nodes`
  std::array<sim::Ticks, path_kinds> time{};  ///< by PathKind
  std::vector<sim::Ticks> nodes;              ///< by the node for which the work was done
  std::vector<PathLevel> levels;  ///< level 1, the root's, is first; steps at no tree node are left out
  /// Stretches in which one node does its own work, or one kind of resource works for one node.
  std::int64_t pieces = 0;
  std::int64_t node_changes = 0;  ///< how often a piece is another node's than the one before it
};

/// Adds up the chain that ends with `tip`. Throws InternalError unless its pieces add up to its end.
[[nodiscard]] CriticalPath add_up(const PathPieces& pieces, const PathTip& tip, std::uint32_t nodes,
                                  LogLevels& levels);

}  // namespace marti::processors::path
