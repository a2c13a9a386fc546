// The settings of the renderer that are measured, and those that must change nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/structure.h"
#include "processors/machine/machine_config.h"
#include "processors/program/render.h"
#include "scenes/scene.h"
#include "studies/error/rendering_keys.h"

namespace marti::studies::error {

/// The parameter that is varied. `exact`: structure, its limits, mailboxes, packets and machine, none of
/// which may change a bit of the image.
enum class Knob : std::uint8_t { samples, depth, weight, precision, voxel_cut, exact };
inline constexpr std::size_t knobs = 6;
inline constexpr std::array<std::string_view, knobs> knob_names = {"samples",   "depth",     "weight",
                                                                   "precision", "voxel_cut", "exact"};

struct RenderingSetting {
  Knob knob = Knob::samples;
  std::string name;
  double value = 0.0;  ///< of the knob; bits of the significand for `precision`; 0 for `exact`
  processors::program::RenderOptions render;
  std::size_t structure = 0;  ///< index into RenderingPlan::structures
  /// The recorded frame is timed on this machine, too, and its run time counts.
  std::optional<processors::machine::MachineConfig> machine;
  bool reference = false;  ///< the knob's own reference: its image must come out bit for bit
};

struct StructurePlan {
  std::string kind;
  accel::StructureOptions options;
};

struct RenderingPlan {
  processors::program::RenderOptions base;  ///< the frame's, made small; each knob changes its own part
  std::vector<StructurePlan> structures;    ///< the first is the frame's own
  std::vector<RenderingSetting> settings;   ///< knob by knob, in the order of Knob, by ascending value
  std::vector<std::string> notes;           ///< what was left out, and why
};

[[nodiscard]] RenderingPlan plan_rendering(const keys::FrameConfig& frame,
                                           const RenderingErrorOptions& options, const scenes::Scene& scene);

}  // namespace marti::studies::error
