#include "studies/frames/frame_sequence.h"

#include <utility>

#include "scenes/open.h"
#include "studies/host/image_file.h"
#include "studies/run/open_frame.h"

namespace marti::studies::frames {

FrameSequence::FrameSequence(const keys::FrameConfig& config)
    : FrameSequence(run::with_scene_keys(
                        [&] { return scenes::open_animated(config.scene, config.open, host::decode_image); }),
                    config.frames) {}

FrameSequence::FrameSequence(scenes::AnimatedScene scene, const keys::FrameRange& range)
    : scene_(std::move(scene)), range_(range) {
  for (std::uint32_t i = 0; i < range_.count; ++i) {
    const scenes::Bounds frame = scenes::bounds_of(pose(i));
    if (!frame.empty()) {
      bounds_.include(frame.lo);
      bounds_.include(frame.hi);
    }
  }
}

scenes::Scene FrameSequence::pose(std::uint32_t i) const {
  return run::with_scene_keys([&] { return scene_.at(range_.time(i)); });
}

void FrameSequence::visit(const std::function<void(const PosedFrame&)>& visitor) const {
  PosedFrame before;
  for (std::uint32_t i = 0; i < range_.count; ++i) {
    PosedFrame frame;
    frame.number = range_.first + i;
    frame.seconds = range_.time(i);
    frame.scene = pose(i);
    if (i > 0) {
      frame.moved = scenes::moved_primitives(before.scene, frame.scene);
    }
    visitor(frame);
    before = std::move(frame);
  }
}

}  // namespace marti::studies::frames
