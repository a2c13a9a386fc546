#include "studies/frames/frames_config.h"

#include <glm/vec3.hpp>
#include <string>

#include "processors/replay.h"
#include "sim/units.h"
#include "studies/build_keys.h"
#include "studies/frames/frame_ways.h"
#include "studies/machine_keys.h"

namespace marti::studies {

namespace {

/// The images of all frames are kept until all are done, so that their files appear together.
void refuse_many_images(const sim::Config& config, const FrameConfig& frame) {
  const double bytes =
      static_cast<double>(frame.frames.count) * frame.render.width * frame.render.height * sizeof(glm::vec3);
  if (bytes > static_cast<double>(frame.memory_limit)) {
    config.fail("frames.count",
                "the images of " + std::to_string(frame.frames.count) + " frames take " +
                    sim::print_size(static_cast<std::int64_t>(bytes) >> 20U << 20U) +
                    ", more than host_machine.memory_limit = " + sim::print_size(frame.memory_limit));
  }
}

/// All ways are simulated at the same time.
void refuse_large_machines(const sim::Config& config, const FramesConfig& frames) {
  const double bytes =
      static_cast<double>(frame_ways) * static_cast<double>(processors::host_bytes(frames.machine));
  if (bytes > static_cast<double>(frames.frame.memory_limit)) {
    config.fail("machine.nodes", "simulating " + std::to_string(frame_ways) +
                                     " machines of these nodes and their caches would take more than "
                                     "host_machine.memory_limit = " +
                                     sim::print_size(frames.frame.memory_limit));
  }
}

}  // namespace

FramesConfig read_frames(sim::Config& config) {
  FramesConfig frames;
  frames.frame = read_frame(config);
  if (frames.frame.structure != "octree") {
    config.fail("structure.kind", "only an octree is rebuilt in part");
  }
  if (frames.frame.exact_too) {
    config.fail("image.voxel_cut_reference",
                "the study renders no exact image beside one with the voxel cut");
  }
  frames.machine = read_machine(config);
  frames.machine.build = read_dynamic_build(config);
  check_machine(config, frames.machine);
  frames.verify = config.boolean("frames.verify");
  config.refuse_unused();
  refuse_many_images(config, frames.frame);
  refuse_large_machines(config, frames);
  return frames;
}

}  // namespace marti::studies
