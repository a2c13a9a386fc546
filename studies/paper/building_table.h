// Tables 2 to 5 of the paper: what it takes to build the octree to an initial level before the frame, and the
// rest of it when a ray first needs it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "memory/layout.h"
#include "studies/paper/traced_run.h"
#include "studies/results/table.h"

namespace marti::studies {

/// An initial level to try.
struct InitialLevel {
  std::uint32_t level = 1;
  bool whole = false;         ///< the whole tree is built before the frame
  std::vector<double> rules;  ///< k of the rules that choose this level

  /// "whole tree", "k = 3", "k = 3, k = 10", or nothing.
  [[nodiscard]] std::string note() const;
};

/// The configured levels above the tree's deepest, those that the rules choose, and the whole tree, which
/// comes last; ascending, each once.
[[nodiscard]] std::vector<InitialLevel> initial_levels(const PaperConfig& config,
                                                       std::span<const LevelCount> levels);

/// The tree that a frame on one shared tree leaves.
struct BuiltTree {
  InitialLevel initial;
  std::vector<LevelCount> levels;

  [[nodiscard]] LevelCount total() const;
};

[[nodiscard]] std::vector<BuiltTree> built_trees(const PaperConfig& config, const TracedRun& run);

}  // namespace marti::studies
