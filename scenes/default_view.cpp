#include "scenes/default_view.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace marti::scenes {

void frame_camera(Scene& scene) {
  const Bounds bounds = bounds_of(scene);
  const glm::dvec3 center = bounds.lo + (bounds.hi - bounds.lo) * 0.5;
  const double half_diagonal = glm::length(bounds.hi - bounds.lo) * 0.5;
  const double radius = half_diagonal > 0.0 ? half_diagonal : std::max(1.0, glm::length(center)) * 0.5;
  scene.camera = Camera{};
  scene.camera.at = center;
  const double distance = 1.05 * radius / std::sin(scene.camera.vertical_fov / 2.0);
  scene.camera.eye = center + distance * glm::normalize(glm::dvec3(0.5, 0.4, 1.0));
}

void add_default_light(Scene& scene) {
  const glm::dvec3 sight = glm::normalize(scene.camera.at - scene.camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(sight, scene.camera.up));
  const glm::dvec3 up = glm::cross(right, sight);
  Light light;
  light.kind = LightKind::directional;
  light.direction = glm::normalize(sight + 0.4 * right - 0.6 * up);
  light.color = glm::dvec3(0.8);
  scene.lights.push_back(light);
  scene.ambient = glm::dvec3(0.2);
}

}  // namespace marti::scenes
