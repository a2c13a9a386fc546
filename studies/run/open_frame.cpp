#include "studies/run/open_frame.h"

#include "sim/error.h"
#include "studies/host/image_file.h"

namespace marti::studies::run {

scenes::Scene open_frame(const keys::FrameConfig& frame, scenes::FileUse* use) {
  sim::ensure(frame.log == nullptr, "the scene of a frame is asked for, of which there is only the log");
  return with_scene_keys(
      [&] { return scenes::open_scene(frame.scene, frame.open, host::decode_image, use); });
}

}  // namespace marti::studies::run
