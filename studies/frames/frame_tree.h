// The octree of each frame, by update of the one before.
#pragma once

#include <memory>
#include <optional>

#include "accel/octree.h"
#include "accel/octree_update.h"
#include "accel/structure.h"
#include "scenes/scene.h"

namespace marti::studies::frames {

struct FrameTree {
  std::shared_ptr<const accel::TriangleSet> triangles;
  std::shared_ptr<const accel::StructureOf<accel::Octree>> octree;
  /// The update from the tree of the frame before; std::nullopt for the first frame.
  std::optional<accel::OctreeUpdate> update;
  double build_seconds = 0.0;   ///< host: building it from nothing, on all threads
  double update_seconds = 0.0;  ///< host: updating it, on one thread; 0 for the first frame

  [[nodiscard]] const accel::Topology& topology() const { return octree->topology(); }
};

/// The tree of a pose: built from nothing, and updated from `before` if that is not null. Both must be equal,
/// node by node and entry by entry: else InternalError. The options enclose all frames (OctreeOptions).
/// Throws UserError as Octree::build and update_octree do.
[[nodiscard]] FrameTree make_frame_tree(const FrameTree* before, const scenes::Scene& scene,
                                        const accel::OctreeOptions& options);

}  // namespace marti::studies::frames
