// Rebuilds an octree in part: from the tree over triangles before some of them moved it makes the tree
// afterwards, which equals that of a fresh build, node by node and entry by entry. "Triangles" here means all
// primitives.
//
// Nodes that list no moved triangle, before or after, are kept with everything below them (unless max_entries
// cuts one of the trees: which nodes it leaves undivided depends on the whole tree). In a node that remains a
// branch only the moved triangles are sorted again; where the others go is known. A branch that need not be
// divided any more, because it lists few triangles or dividing it separates nothing, becomes a leaf; a leaf
// that lists too many triangles is split. Where more triangles moved than a node lists, all its triangles are
// sorted again.
//
// (Partial rebuilding in dynamic scenes: McNeill, Shah, Hebert, Lister, Grimsdale, Computer Graphics Forum
// 11(4), 1992, on animation.)
#pragma once

#include <cstdint>
#include <vector>

#include "accel/octree.h"
#include "accel/octree_build.h"
#include "accel/topology.h"
#include "accel/triangles.h"

namespace marti::accel {

/// What an update did to a node of the new tree.
enum class NodeUpdate : std::uint8_t {
  kept,       ///< it lists no moved triangle, before or after: its record and list are unchanged
  resorted,   ///< a branch before and after: the moved triangles among its own were sorted into its children
  split,      ///< a branch whose children were made anew, from its whole list
  listed,     ///< a leaf before and after, with moved triangles among those it listed or lists
  collapsed,  ///< a leaf that was a branch
  made,       ///< a leaf below a branch that was split
};

inline constexpr std::uint32_t no_old_node = 0xffffffffU;

struct OctreeUpdate {
  /// The tree of a fresh build: topology (with the work of a fresh build), levels, cut.
  OctreeBuild build;
  /// [node of the new tree]
  std::vector<NodeUpdate> nodes;
  /// [node of the new tree] The work of the update, in the terms of a split: `listed` triangles were sorted
  /// (a moved one counts once for its old and once for its new place), with `overlaps` tests. {0, 0} for kept
  /// nodes; a leaf has some where the attempt to split it separated nothing (also a kept one, where
  /// max_entries had left it undivided before).
  std::vector<SplitWork> work;
  /// [node of the new tree] The old tree's node of the same cell, whose state it continues; no_old_node below
  /// a node that was split.
  std::vector<std::uint32_t> was;
  std::uint32_t moved = 0;  ///< triangles that moved

  /// Whether the node's own record or list must be made again. Where altered nodes become P nodes instead of
  /// being divided at once, these branches do.
  [[nodiscard]] bool altered(std::uint32_t node) const { return nodes[node] != NodeUpdate::kept; }
};

/// Updates the tree `before` to the triangles `after`, with the same options. Throws UserError when there are
/// not as many triangles as before, and when the root box differs (give OctreeOptions::enclose to the first
/// build to keep it).
[[nodiscard]] OctreeUpdate update_octree(const Octree& before, const TriangleSet& after);

}  // namespace marti::accel
