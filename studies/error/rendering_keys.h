// Keys of the rendering family of `marti study error`: which settings are rendered, and against what.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/config.h"
#include "sim/schema.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::error {

struct RenderingErrorOptions {
  std::uint32_t side = 64;             ///< pixels of the image's longer side at most
  std::vector<std::uint32_t> samples;  ///< a pixel; ascending, each once; not empty
  /// Samples of each of the two references of knob `samples`; at least 16 times the largest of `samples`.
  /// More than one rendering may have are split over several renderings.
  std::uint32_t reference_samples = 1024;
  std::vector<std::uint32_t> depths;  ///< ascending, each once, below reference_depth
  std::uint32_t reference_depth = 16;
  std::vector<double> weights;     ///< ascending, each once, above 0
  std::vector<double> voxel_cuts;  ///< ascending, each once, above 0
  std::uint64_t seed = 1;          ///< of all samples; references and repeats have seeds above it
  std::uint32_t repeats = 7;       ///< of every measurement of run time; each has other samples
};

void declare_rendering_error_keys(sim::Schema& schema);

/// Throws UserError naming file, line and key. `frame` is what is rendered.
[[nodiscard]] RenderingErrorOptions read_rendering_error(sim::Config& config, const keys::FrameConfig& frame);

}  // namespace marti::studies::error
