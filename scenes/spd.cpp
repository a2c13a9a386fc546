#include "scenes/spd.h"

#include <bit>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace marti::scenes::spd {

double shininess_of_angle(double degrees) {
  if (degrees <= 0.0) {
    return 100'000.0;
  }
  return std::log(0.5) / std::log(std::cos(degrees * std::numbers::pi / 180.0));
}

void set_lights(Scene& scene, std::span<const glm::dvec3> positions) {
  const double count = static_cast<double>(positions.size());
  const double intensity = std::sqrt(count) / (2.0 * count);
  for (const glm::dvec3& position : positions) {
    Light light;
    light.kind = LightKind::point;
    light.position = position;
    light.color = glm::dvec3(intensity);
    scene.lights.push_back(light);
  }
  scene.ambient = glm::dvec3(intensity);
}

Scene make_scene(const glm::dvec3& eye, const glm::dvec3& at, const glm::dvec3& up) {
  Scene scene;
  scene.camera.eye = eye;
  scene.camera.at = at;
  scene.camera.up = up;
  scene.camera.vertical_fov = std::numbers::pi / 4.0;
  scene.background = {0.078, 0.361, 0.753};
  return scene;
}

std::size_t VertexWelder::Hash::operator()(const glm::dvec3& p) const {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    // + 0.0 turns -0 into +0, which compares equal and must hash equal.
    hash = (hash ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 29U;
  }
  return static_cast<std::size_t>(hash);
}

std::uint32_t VertexWelder::add(const glm::dvec3& position, const glm::dvec3& normal) {
  std::vector<std::uint32_t>& known = at_[position];
  const bool has_normals = normal != glm::dvec3(0.0) || !scene_.normals.empty();
  for (const std::uint32_t index : known) {
    const glm::dvec3 other = scene_.normals.empty() ? glm::dvec3(0.0) : scene_.normals[index];
    if (glm::length(other - normal) <= 1e-9) {
      return index;
    }
  }
  const auto index = static_cast<std::uint32_t>(scene_.positions.size());
  if (has_normals) {
    scene_.normals.resize(index, glm::dvec3(0.0));
    scene_.normals.push_back(normal);
  }
  scene_.positions.push_back(position + 0.0);
  known.push_back(index);
  return index;
}

}  // namespace marti::scenes::spd
