#include "studies/frames/frames_config.h"

#include <glm/vec3.hpp>
#include <string>

#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "studies/frames/frame_ways.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::frames {

namespace {

/// The images of all frames are kept until all are done, so that their files appear together.
void refuse_many_images(const sim::Config& config, const keys::FrameConfig& frame) {
  const std::uint64_t bytes =
      std::uint64_t{frame.frames.count} * frame.render.width * frame.render.height * sizeof(glm::vec3);
  if (const std::string excess = frame.memory.excess(bytes); !excess.empty()) {
    config.fail("frames.count",
                "the images of " + std::to_string(frame.frames.count) + " frames take" + excess);
  }
}

/// All ways are simulated at the same time.
void refuse_large_machines(const sim::Config& config, const FramesConfig& frames) {
  const std::string excess = frames.frame.memory.excess(
      frame_ways *
      processors::replay::host_bytes(frames.machine, frames.frame.render.width, frames.frame.render.height));
  if (!excess.empty()) {
    config.fail("machine.nodes", "simulating " + std::to_string(frame_ways) +
                                     " machines of these nodes and their caches takes" + excess);
  }
}

}  // namespace

FramesConfig read_frames(sim::Config& config) {
  FramesConfig frames;
  frames.frame = keys::read_frame(config, keys::FrameUse::frames);
  const bool refits = frames.frame.structure == "bvh";
  if (!refits && frames.frame.structure != "octree") {
    config.fail("structure.kind", "an octree is rebuilt in part and a bvh refitted; others have no updates");
  }
  if (frames.frame.exact_too) {
    config.fail("image.voxel_cut_reference",
                "the study renders no exact image beside one with the voxel cut");
  }
  frames.machine = keys::read_machine(config);
  frames.machine.build = refits ? keys::read_build(config) : keys::read_dynamic_build(config);
  keys::check_machine(config, frames.machine);
  if (refits) {
    config.mark_unused_reason("frames.verify", "with a bvh the images of all trees are always compared");
  } else {
    frames.verify = config.boolean("frames.verify");
  }
  config.refuse_unused();
  refuse_many_images(config, frames.frame);
  refuse_large_machines(config, frames);
  return frames;
}

}  // namespace marti::studies::frames
