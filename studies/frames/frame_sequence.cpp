#include "studies/frames/frame_sequence.h"

#include <utility>

#include "scenes/open.h"
#include "studies/image_file.h"

namespace marti::studies {

FrameSequence::FrameSequence(const FrameConfig& config)
    : FrameSequence(scenes::open_animated(config.scene, config.open, decode_image), config.frames) {}

FrameSequence::FrameSequence(scenes::AnimatedScene scene, const FrameRange& range)
    : scene_(std::move(scene)), range_(range) {
  for (std::uint32_t i = 0; i < range_.count; ++i) {
    const scenes::Bounds frame = scenes::bounds_of(scene_.at(range_.time(i)));
    if (!frame.empty()) {
      bounds_.include(frame.lo);
      bounds_.include(frame.hi);
    }
  }
}

void FrameSequence::visit(const std::function<void(const PosedFrame&)>& visitor) const {
  PosedFrame before;
  for (std::uint32_t i = 0; i < range_.count; ++i) {
    PosedFrame frame;
    frame.number = range_.first + i;
    frame.seconds = range_.time(i);
    frame.scene = scene_.at(frame.seconds);
    if (i > 0) {
      frame.moved = scenes::moved_primitives(before.scene, frame.scene);
    }
    visitor(frame);
    before = std::move(frame);
  }
}

}  // namespace marti::studies
