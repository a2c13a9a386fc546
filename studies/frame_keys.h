// The configuration keys of the functional world: scene, image, structure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "scenes/open.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies {

/// What is traced, and how. Equal values give the same image and the same work log.
struct FrameConfig {
  std::string scene;
  scenes::OpenOptions open;
  std::string structure;
  accel::StructureOptions structure_options;
  processors::RenderOptions render;
  bool exact_too = false;         ///< with the voxel cut: render the exact image beside it
  std::int64_t memory_limit = 0;  ///< host bytes that image and work log may take
};

void declare_frame_keys(sim::Schema& schema);

/// Throws UserError naming file, line and key.
[[nodiscard]] FrameConfig read_frame(sim::Config& config);

}  // namespace marti::studies
