// The options of an octree, and its statistics.
#pragma once

#include <cstdint>

#include "accel/octree_sort.h"
#include "scenes/scene.h"
#include "sim/memory_budget.h"

namespace marti::accel {

struct OctreeOptions {
  /// A node that lists more than this many triangles is split, unless it is at max_level. At least 1.
  std::uint32_t max_objects = 8;
  /// The deepest level; the root is level 1. From 1 to 21.
  std::uint32_t max_level = 12;
  /// No node is split once the leaves made so far and the waiting nodes list more than this many triangles in
  /// all; it bounds the memory of hostile scenes (4 bytes an entry). At least 1.
  std::uint64_t max_entries = std::uint64_t{1} << 25;
  /// A box that the root box must contain too; empty: only the triangles. Give the bounds of all frames when
  /// triangles move, so that the trees of all frames have the same cells (octree_update.h). See make_frame.
  scenes::Bounds enclose{};
  /// Host threads that build; 0: all. The tree is the same with any number.
  unsigned threads = 0;
  /// The host memory for the tree and its building; if more is needed, a UserError is thrown as it grows.
  sim::MemoryBudget memory{};
};

/// One level of the tree.
struct LevelStatistics {
  std::uint64_t branches = 0;
  std::uint64_t leaves = 0;  ///< empty ones included
  std::uint64_t empty_leaves = 0;
  std::uint64_t entries = 0;          ///< triangles listed in this level's leaves
  std::uint64_t overfull_leaves = 0;  ///< leaves with more than max_objects entries

  [[nodiscard]] std::uint64_t nodes() const { return branches + leaves; }
  bool operator==(const LevelStatistics&) const = default;
};

}  // namespace marti::accel
