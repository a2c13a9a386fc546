// What of a frame's tree is left from the frame before, in the terms of the timing world.
//
// The timing world knows one way to make a node's children: to split it, from its whole list, and to write
// the records and lists of all its children. So a node whose moved triangles alone are sorted anew
// (accel::NodeUpdate::resorted) is charged as if it were split: more than it takes, unless almost all of its
// triangles moved.
// It charges nothing for finding out what moved, and nothing for gathering again the list of a branch from
// the leaves below it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/octree_update.h"
#include "processors/walk/build_start.h"

namespace marti::studies::frames {

/// Rebuilding in part: altered branches are split before the frame, all others are kept.
[[nodiscard]] std::vector<processors::walk::BranchStart> partial_starts(const accel::OctreeUpdate& update);

/// Rebuilding in part and on demand, after a frame that left the branches `built` of the old tree with their
/// children (one entry a node of it):
///   a branch that is not altered is kept if it was built, and still a P node if not;
///   an altered branch returns to P, unless it was built and a kept one lies below it: then it is split
///   before the frame, so that what is below can stay.
/// Throws InternalError when `built` does not fit the old tree.
[[nodiscard]] std::vector<processors::walk::BranchStart> carried_starts(const accel::OctreeUpdate& update,
                                                                        std::span<const std::uint8_t> built);

}  // namespace marti::studies::frames
