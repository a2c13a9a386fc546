// The frames of an animation one after another: how each begins, and the tree that it has.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "accel/octree.h"
#include "accel/octree_update.h"
#include "accel/structure.h"
#include "processors/program/render.h"
#include "processors/walk/build_start.h"
#include "scenes/animated.h"
#include "scenes/scene.h"
#include "sim/work_meter.h"
#include "studies/keys/frame_keys.h"

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

struct PosedFrame {
  std::uint32_t number = 0;  ///< as the animation counts: frames.first for the first of the sequence
  double seconds = 0.0;      ///< from the animation's beginning
  scenes::Scene scene;
  std::vector<std::uint32_t>
      moved;  ///< primitives that moved since the frame before, ascending; none in the first
};

/// Traces a pose and records its log. Throws UserError where its memory does not suffice, and Stopped after
/// `meter` was stopped.
[[nodiscard]] processors::program::Frame trace_pose(const keys::FrameConfig& config, const PosedFrame& pose,
                                                    const accel::TriangleSet& triangles,
                                                    const accel::Structure& structure, sim::WorkMeter& meter);

/// A scene that stands still has the same pose in every frame.
class FrameSequence {
 public:
  /// Opens the scene and poses every frame once. Throws UserError when the scene cannot be used or a frame
  /// cannot be posed.
  explicit FrameSequence(const keys::FrameConfig& config);
  FrameSequence(scenes::AnimatedScene scene, const keys::FrameRange& range);

  [[nodiscard]] std::uint32_t size() const { return range_.count; }

  /// The box of all triangles in all frames: as the root of a tree it gives all frames the same cells.
  [[nodiscard]] const scenes::Bounds& bounds() const { return bounds_; }

  [[nodiscard]] const scenes::AnimatedScene& scene() const { return scene_; }

  /// Poses the frames in order and gives each to `visitor`. Two poses are in memory at a time.
  void visit(const std::function<void(const PosedFrame&)>& visitor) const;

 private:
  [[nodiscard]] scenes::Scene pose(std::uint32_t i) const;

  scenes::AnimatedScene scene_;
  keys::FrameRange range_;
  scenes::Bounds bounds_;
};

}  // namespace marti::studies::frames
