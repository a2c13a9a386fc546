// A pinhole camera and the affine map from the image plane to ray directions.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace marti::scenes {

/// The image plane of one camera at one resolution: the ray through continuous pixel coordinate (x, y),
/// x from 0 (left edge) to width, y from 0 (top edge) to height, starts at `origin` and has the direction
/// corner + x * step_x + y * step_y (not normalised). Pixel centres are at half-integers; the SPD's
/// 513 x 513 corner rays are at the integers.
struct ImagePlane {
  glm::dvec3 origin{0.0};
  glm::dvec3 corner{0.0};
  glm::dvec3 step_x{0.0};
  glm::dvec3 step_y{0.0};
};

struct Camera {
  glm::dvec3 eye{0.0, 0.0, 1.0};
  glm::dvec3 at{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double vertical_fov = 0.7853981633974483;  ///< full angle in radians, above 0 and below pi

  /// Throws UserError when eye, at and up do not span a frame or when a size is zero.
  [[nodiscard]] ImagePlane image_plane(std::uint32_t width, std::uint32_t height) const;
};

}  // namespace marti::scenes
