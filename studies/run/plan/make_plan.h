// The plan of a frame: decided from facts before the frame is rendered, checked afterwards.
//
// Only work and memory of this computer are saved: the simulated machine's database and its work log are
// those of the scene that the user describes, so that all its statistics are the same. The one exception is a
// shadow ray whose light could add nothing: the ray tracer does not send it, on any machine.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "scenes/animated.h"
#include "scenes/scene.h"
#include "scenes/texture.h"
#include "studies/run/plan/needs.h"
#include "studies/run/plan/plan.h"

namespace marti::studies::run {

/// What the decisions rest on.
struct PlanFacts {
  SceneNeeds needs;
  scenes::FileUse file;
  processors::program::RenderOptions render;  ///< as the configuration has it
  KeptItems keep;

  // Of the scene as it was opened.
  std::uint64_t texels = 0;
  std::uint64_t texels_needed = 0;
  std::uint64_t coordinates = 0;  ///< vertices that have texture coordinates
  std::uint64_t normals = 0;      ///< vertices that have normals
};

[[nodiscard]] PlanFacts facts_of_frame(const scenes::Scene& scene,
                                       const processors::program::RenderOptions& render,
                                       const KeptItems& keep);

/// The items of scene and frame. `further` are entries of other items.
[[nodiscard]] Plan make_plan(const PlanFacts& facts, std::vector<PlanEntry> further = {});

/// Adds what is known only when the structure is built, and before the frame is rendered.
void plan_structure(Plan& plan, const PlanFacts& facts, const accel::Structure& structure);

[[nodiscard]] bool is_left_out(const Plan& plan, PlanItem item);

/// The options that render the frame by the plan.
[[nodiscard]] processors::program::RenderOptions planned_options(const Plan& plan, const PlanFacts& facts);

/// Takes out of the scene what the plan leaves out, and decodes the texels that are needed. Textures that
/// cannot be decoded become white, with a note, or are refused if `strict`.
void drop_parts(const Plan& plan, const SceneNeeds& needs, const scenes::ImageDecoder& decode, bool strict,
                scenes::Scene& scene);

/// Throws InternalError where the frame has used what was left out. `shades`: how often each material was
/// shaded, as processors::totals_of() says of the frame's log.
void check_plan(const Plan& plan, const SceneNeeds& needs, const processors::program::Frame& frame,
                std::span<const std::uint64_t> shades);

}  // namespace marti::studies::run
