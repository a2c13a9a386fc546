// Which primitives a camera's rays may meet.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "scenes/camera.h"
#include "scenes/scene.h"

namespace marti::studies::run {

/// The cone of a camera's rays as the half-spaces that it is the intersection of: four sides, and what lies
/// before the eye.
class View {
 public:
  /// Rays go through the pixels' centres, or with several samples anywhere through the pixels.
  View(const scenes::ImagePlane& plane, std::uint32_t width, std::uint32_t height, bool several_samples);

  /// False only when no ray of the camera can meet the primitive: all its corners, or those of its box, lie
  /// beyond one side of the cone or behind the eye, and by more than the kernels round.
  [[nodiscard]] bool may_meet(const scenes::Scene& scene, std::uint32_t primitive) const;

 private:
  template <class Corners>
  [[nodiscard]] bool may_meet(const Corners& corners) const;

  glm::dvec3 eye_;
  std::array<glm::dvec3, 5> outward_{};  ///< unit normals of the sides
  bool usable_ = false;                  ///< false: the cone is too thin, or not finite
};

}  // namespace marti::studies::run
