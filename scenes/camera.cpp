#include "scenes/camera.h"

#include <cmath>
#include <numbers>
#include <string>

#include <glm/geometric.hpp>

#include "sim/error.h"

namespace marti::scenes {

ImagePlane Camera::image_plane(std::uint32_t width, std::uint32_t height) const {
  if (width == 0 || height == 0) {
    throw sim::UserError("camera: an image of " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels has no pixels; both sizes must be at least 1");
  }
  if (!(vertical_fov > 0.0 && vertical_fov < std::numbers::pi)) {
    throw sim::UserError("camera: the vertical field of view must lie between 0 and 180 degrees, not " +
                         std::to_string(vertical_fov * 180.0 / std::numbers::pi));
  }
  const glm::dvec3 sight = at - eye;
  const double distance = glm::length(sight);
  const double up_length = glm::length(up);
  if (!(distance > 0.0) || !std::isfinite(distance)) {
    throw sim::UserError("camera: the eye and the point it looks at must be finite and differ");
  }
  if (!(up_length > 0.0) || !std::isfinite(up_length)) {
    throw sim::UserError("camera: the up direction must be finite and not zero");
  }
  const glm::dvec3 forward = sight / distance;
  const glm::dvec3 side = glm::cross(forward, up / up_length);
  const double sine = glm::length(side);
  if (!(sine > 1e-12)) {
    throw sim::UserError("camera: the up direction is parallel to the line of sight");
  }
  const glm::dvec3 right = side / sine;
  const glm::dvec3 upward = glm::cross(right, forward);
  const double half_height = std::tan(vertical_fov / 2.0);
  const double half_width = half_height * static_cast<double>(width) / static_cast<double>(height);
  ImagePlane plane;
  plane.origin = eye;
  plane.corner = forward - half_width * right + half_height * upward;
  plane.step_x = right * (2.0 * half_width / static_cast<double>(width));
  plane.step_y = upward * (-2.0 * half_height / static_cast<double>(height));
  return plane;
}

}  // namespace marti::scenes
