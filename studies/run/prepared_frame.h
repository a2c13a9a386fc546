// A frame that is ready to be traced, whole or in parts.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "accel/structure.h"
#include "accel/triangles.h"
#include "processors/program/render.h"
#include "scenes/open.h"
#include "studies/run/functional_run.h"
#include "studies/run/plan/make_plan.h"

namespace marti::studies::run {

/// A frame of which all is ready to be traced: the scene is open, what the frame does not need is left out,
/// and the structure is built. Parts of it can be traced one after another.
class PreparedFrame {
 public:
  /// Throws UserError when the scene cannot be used or the frame would take more than the memory limit, which
  /// it estimates from a small rendering.
  explicit PreparedFrame(const keys::FrameConfig& config);
  /// Like the first, of a scene that is open already, whose textures may still be files.
  PreparedFrame(const keys::FrameConfig& config, scenes::Scene scene, scenes::FileUse file);
  /// Like the first, of the open scene that `config` names. Nothing of it is left out.
  PreparedFrame(const keys::FrameConfig& config, const scenes::Scene& scene);

  [[nodiscard]] const keys::FrameConfig& config() const { return config_; }
  [[nodiscard]] const std::shared_ptr<const accel::TriangleSet>& triangles() const { return triangles_; }
  [[nodiscard]] const std::shared_ptr<const accel::Structure>& structure() const { return structure_; }
  /// Traces and records the pixels of `only`, all if it is null, and adds them to `before`, if that is not
  /// null (processors::RenderOptions).
  [[nodiscard]] processors::program::Frame trace(const processors::program::PixelSet* only = nullptr,
                                                 const processors::program::Frame* before = nullptr) const;
  /// The run of a frame of which only a part is traced: what was not counted of the whole is missing.
  [[nodiscard]] FunctionalRun part(processors::program::Frame frame) const;
  /// The run of the whole frame.
  [[nodiscard]] FunctionalRun finish(processors::program::Frame frame) const;

 private:
  // Leaves out of the scene what the frame does not need, then prepares it.
  void prepare_planned(scenes::Scene scene, scenes::FileUse file);
  void prepare(const scenes::Scene& scene);

  keys::FrameConfig config_;
  std::unique_ptr<const scenes::Scene> own_scene_;  // null if the caller has the scene
  const scenes::Scene* scene_ = nullptr;
  std::optional<PlanFacts> facts_;  // empty: nothing is left out
  std::shared_ptr<const accel::TriangleSet> triangles_;
  std::shared_ptr<const accel::Structure> structure_;
  FunctionalRun run_;  // all but the frame
};

}  // namespace marti::studies::run
