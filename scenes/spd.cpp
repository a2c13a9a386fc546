#include "scenes/spd.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

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

Material make_material(std::string name, const glm::dvec3& color, double diffuse, double reflection,
                       double highlight, double angle) {
  Material material;
  material.name = std::move(name);
  material.color = color;
  material.diffuse = diffuse;
  material.reflection = reflection;
  material.highlight = highlight;
  if (highlight > 0.0) {
    material.shininess = shininess_of_angle(angle);
  }
  return material;
}

std::uint32_t add_material(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

namespace {

void add_quadric(Scene& scene, Quadric quadric) {
  quadric.source = static_cast<std::uint32_t>(scene.quadrics.size());
  scene.quadrics.push_back(quadric);
}

}  // namespace

void add_sphere(Scene& scene, const glm::dvec3& center, double radius, std::uint32_t material) {
  add_quadric(scene, {.kind = QuadricKind::sphere, .base = center, .radius = radius, .material = material});
}

void add_cylinder(Scene& scene, const glm::dvec3& base, const glm::dvec3& tip, double radius,
                  std::uint32_t material) {
  add_quadric(
      scene,
      {.kind = QuadricKind::cylinder, .base = base, .tip = tip, .radius = radius, .material = material});
}

void add_cone(Scene& scene, const glm::dvec3& base, const glm::dvec3& tip, double radius, double tip_radius,
              std::uint32_t material) {
  add_quadric(scene, {.kind = QuadricKind::cone,
                      .base = base,
                      .tip = tip,
                      .radius = radius,
                      .tip_radius = tip_radius,
                      .material = material});
}

void add_square(Scene& scene, const std::array<glm::dvec3, 4>& corners, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
  const auto polygon = static_cast<std::uint32_t>(scene.polygons++);
  scene.triangles.push_back({{first, first + 1, first + 2}, material, polygon});
  scene.triangles.push_back({{first + 2, first + 3, first}, material, polygon});
}

glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& axis, double radians) {
  const double cosine = std::cos(radians);
  return v * cosine + glm::cross(axis, v) * std::sin(radians) + axis * (glm::dot(axis, v) * (1.0 - cosine));
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
