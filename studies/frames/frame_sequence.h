// The frames of an animated scene, posed one after another.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "scenes/animated.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::frames {

struct PosedFrame {
  std::uint32_t number = 0;  ///< as the animation counts: frames.first for the first of the sequence
  double seconds = 0.0;      ///< from the animation's beginning
  scenes::Scene scene;
  std::vector<std::uint32_t>
      moved;  ///< primitives that moved since the frame before, ascending; none in the first
};

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
