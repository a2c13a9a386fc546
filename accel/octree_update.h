// Rebuilding an octree in part: from the tree over triangles before some of them moved to the tree over them
// afterwards, which is the one a fresh build gives, node by node and entry by entry. What is said of
// triangles here holds for all primitives.
//
// Nodes that list no moved triangle, neither before nor after, are kept with all that is below them (unless
// max_entries cuts one of the trees: what it leaves undivided depends on the whole tree). In a
// node that stays a branch only the moved triangles are sorted anew: what its other triangles do is known. A
// branch that has come to be divided for nothing or to list few enough triangles is collapsed to a leaf; a
// leaf that lists too many is split. Where more triangles moved than a node lists, it is sorted anew as a
// whole.
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
  kept,       ///< it lists no moved triangle, before or after: its record and list are as they were
  resorted,   ///< a branch before and after: the moved triangles among its own were sorted into its children
  split,      ///< a branch whose children were made anew, from its whole list
  listed,     ///< a leaf before and after, with moved triangles among those it listed or lists
  collapsed,  ///< a leaf that was a branch
  made,       ///< a leaf below a branch that was split
};

inline constexpr std::uint32_t no_old_node = 0xffffffffU;

struct OctreeUpdate {
  /// The tree of a fresh build: topology (its work as of a fresh build), levels, cut.
  OctreeBuild build;
  /// [node of the new tree]
  std::vector<NodeUpdate> nodes;
  /// [node of the new tree] What was done now, in the terms of a split: `listed` triangles were sorted (a
  /// moved one counts once for where it was and once for where it is), for which `overlaps` tests were run.
  /// {0, 0} for what was kept; a leaf has some where it turned out that splitting it separates nothing (a
  /// kept one too, where max_entries had left it undivided before).
  std::vector<SplitWork> work;
  /// [node of the new tree] The old tree's node of the same cell, whose state it goes on with; no_old_node
  /// below a node that was split.
  std::vector<std::uint32_t> was;
  std::uint32_t moved = 0;  ///< triangles that moved

  /// Whether the node's own record or list must be made anew. Where altered nodes return to P instead of
  /// being divided at once, these branches do.
  [[nodiscard]] bool altered(std::uint32_t node) const { return nodes[node] != NodeUpdate::kept; }
};

/// The ids of the primitives that differ in any bit of their coordinates, ascending. Throws UserError when
/// there are not as many of triangles or of others after as before.
[[nodiscard]] std::vector<std::uint32_t> moved_primitives(const TriangleSet& before,
                                                          const TriangleSet& after);

/// The update of `before` to the triangles `after`, built by the same options. Throws UserError when there
/// are not as many triangles as before, and when the root box is another one (OctreeOptions::enclose, given
/// to the first build, keeps it).
[[nodiscard]] OctreeUpdate update_octree(const Octree& before, const TriangleSet& after);

}  // namespace marti::accel
