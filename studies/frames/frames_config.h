// The configuration of `marti study frames`: the keys of a run.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::frames {

struct FramesConfig {
  keys::FrameConfig frame;
  /// Its `build` is that of the ways that build on demand: shared or private, with the initial tree.
  processors::machine::MachineConfig machine;
  bool verify = true;  ///< render every frame with a tree built from nothing too
};

/// Throws UserError naming file, line and key: what read_frame, read_machine and read_dynamic_build refuse;
/// another structure than an octree; frames or machines that would take more than the memory limit.
[[nodiscard]] FramesConfig read_frames(sim::Config& config);

}  // namespace marti::studies::frames
