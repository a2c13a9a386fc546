// The functional world's part of a run: scene, structure, image and work log.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "accel/octree.h"
#include "processors/program/render.h"
#include "scenes/open.h"
#include "studies/keys/frame_keys.h"
#include "studies/run/plan/plan.h"
#include "studies/run/voxel_report.h"

namespace marti::studies::run {

struct FunctionalRun {
  scenes::SceneFacts scene;
  std::vector<std::string> notes;              ///< what the loader chose or left out
  std::vector<std::string> structure_notes;    ///< what its builder chose
  std::vector<accel::LevelStatistics> levels;  ///< of an octree; empty for other structures
  processors::program::Frame frame;
  processors::program::LogTotals totals;
  std::optional<VoxelReport> voxel_cut;  ///< with the voxel cut
  std::uint64_t image_hash = 0;          ///< of the pixels' bits
  Plan plan;                             ///< what was left out; empty where the scene was open already
};

/// FNV-1a (Fowler, Noll, Vo) over the bits of all pixels.
[[nodiscard]] std::uint64_t image_hash(const processors::program::Image& image);

/// Throws UserError when the frame's image and log would take more than the memory limit, by an estimate
/// from a small rendering.
void refuse_beyond_memory(const keys::FrameConfig& config, const scenes::Scene& scene,
                          const accel::TriangleSet& triangles, const accel::Structure& structure);

/// Opens the scene, plans what the frame does not need, builds the structure, renders and records; or reads
/// the log that `config` names (saved_frame.h). Throws UserError when the scene or the log cannot be used or
/// the frame would take more than the memory limit, which it estimates from a small rendering.
[[nodiscard]] FunctionalRun run_functional(const keys::FrameConfig& config);
/// Like run_functional above, of the open scene that `config` names. Nothing of it is left out.
[[nodiscard]] FunctionalRun run_functional(const keys::FrameConfig& config, const scenes::Scene& scene);

}  // namespace marti::studies::run
