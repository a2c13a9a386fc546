// The configuration keys of the functional world: scene, image, structure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "scenes/open.h"
#include "sim/config.h"
#include "sim/memory_budget.h"
#include "sim/schema.h"
#include "sim/work_meter.h"
#include "studies/keys/logged_frame.h"
#include "studies/run/plan/plan.h"

namespace marti::studies::run {
class ExpectedTimes;
}

namespace marti::studies::keys {

/// Which frames of an animated scene.
struct FrameRange {
  std::uint32_t count = 1;
  std::uint32_t first = 0;
  double rate = 24.0;  ///< frames a second

  /// Seconds from the animation's beginning, of frame `first + i`.
  [[nodiscard]] double time(std::uint32_t i) const {
    return (static_cast<double>(first) + static_cast<double>(i)) / rate;
  }
};

/// What is traced, and how. Equal values give the same image and the same work log.
struct FrameConfig {
  std::string scene;
  scenes::OpenOptions open;  ///< its time is that of the first frame
  FrameRange frames;
  std::string structure;
  accel::StructureOptions structure_options;
  processors::program::RenderOptions render;
  bool exact_too = false;           ///< with the voxel cut: render the exact image beside it
  sim::MemoryBudget memory;         ///< of scene, structure, image and work log together
  run::KeptItems keep;              ///< plan items to keep; no configuration key, as it changes no result
  sim::WorkMeter* meter = nullptr;  ///< is told how far the frame is; null: nobody waits for it
  run::ExpectedTimes* expected = nullptr;  ///< is told what says how long it takes; null: nobody asks
  /// What is traced and how is that of this log, which is read in the place of the scene; null: it is traced.
  std::shared_ptr<const LoggedFrame> log{};

  /// `waiting` may also stop the frame, while its scene is read as well as later; null: nobody waits.
  void wait_with(sim::WorkMeter* waiting) {
    meter = waiting;
    memory.wait_with(waiting);
    open.file.memory.wait_with(waiting);
  }
};

/// The options with the frame made so small that its longer side has at most `side` pixels; a window shows
/// about the same part of the smaller image.
[[nodiscard]] processors::program::RenderOptions made_small(processors::program::RenderOptions options,
                                                            double side);

/// "24 x 16", or of a window "24 x 16 at (8, 4) of 512 x 512".
[[nodiscard]] std::string size_text(const processors::program::RenderOptions& options);

void declare_frame_keys(sim::Schema& schema);

/// The budget by host_machine.memory_limit; if that is 0, an equal share of the host's memory for each of the
/// `processes` that run on it. Throws UserError naming file, line and key.
[[nodiscard]] sim::MemoryBudget read_memory(const sim::Config& config, std::uint64_t processes = 1);

/// Lets the structure, whichever is built, take what is left of the budget.
void give_memory(const sim::MemoryBudget& memory, accel::StructureOptions& options);

/// Where a file that a key of the configuration names is looked for: beside the configuration, or in the
/// current directory (empty) if the command line names it.
[[nodiscard]] std::filesystem::path directory_of(const sim::Config& config, std::string_view key);

/// Throws UserError naming file, line and key. For another use than timing a log is refused, and given rays.
[[nodiscard]] FrameConfig read_frame(sim::Config& config, FrameUse use = FrameUse::timing);

/// Like read_frame, for a study of one frame: refuses several.
[[nodiscard]] FrameConfig read_one_frame(sim::Config& config, FrameUse use);

}  // namespace marti::studies::keys
