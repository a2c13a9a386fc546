// What the voxel cut saved, and what it cost the image.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "processors/program/image.h"
#include "processors/program/render.h"
#include "processors/program/work_log.h"

namespace marti::studies::run {

/// The part of the database that the rays of a log needed. Each record counts once.
struct DatabaseUse {
  std::uint64_t nodes = 0;       ///< whose record was read
  std::uint64_t entries = 0;     ///< in lists of leaves that were tested
  std::uint64_t primitives = 0;  ///< tested
  std::uint64_t voxels = 0;      ///< averaged materials read
  std::vector<std::uint64_t>
      level_nodes;  ///< `nodes` by level, the root's first; as long as the tree is deep
};

[[nodiscard]] DatabaseUse database_use(const processors::program::WorkLog& log);

/// Differences of linear RGB values.
struct ImageError {
  double rmse = 0.0;          ///< root of the mean square over all pixels and channels
  double largest = 0.0;       ///< over all pixels and channels
  std::uint64_t changed = 0;  ///< pixels that differ in any bit
  std::uint64_t visible = 0;  ///< pixels with a channel that differs by more than 1/255
};

/// The images must be of one size.
[[nodiscard]] ImageError image_error(const processors::program::Image& image,
                                     const processors::program::Image& exact);

/// The exact frame beside a cut one.
struct ExactFrame {
  processors::program::Image image;
  processors::program::LogTotals totals;
  DatabaseUse use;
  ImageError error;  ///< of the cut image
};

struct VoxelReport {
  DatabaseUse use;
  std::optional<ExactFrame> exact;  ///< with image.voxel_cut_reference
};

}  // namespace marti::studies::run
