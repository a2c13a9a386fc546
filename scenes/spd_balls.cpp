// SPD balls(n): a sphere flake of 1 + 9 + ... + 9^n spheres on a floor.
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

constexpr glm::dvec3 up{0.0, 0.0, 1.0};

using Directions = std::array<glm::dvec3, 9>;

/// The directions of a ball's nine children when its own axis points up.
Directions directions_of_children() {
  const double d = 1.0 / std::numbers::sqrt2;
  const std::array<glm::dvec3, 3> trio = {glm::dvec3{d, d, 0.0}, glm::dvec3{d, 0.0, -d},
                                          glm::dvec3{0.0, d, -d}};
  Directions directions;
  for (std::size_t set = 0; set < 3; ++set) {
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 tilted = turned(trio[i], {d, -d, 0.0}, std::asin(2.0 / std::sqrt(6.0)));
      directions[3 * set + i] = turned(tilted, up, static_cast<double>(set) * 2.0 * std::numbers::pi / 3.0);
    }
  }
  return directions;
}

/// Rotates a vector as the rotation from "up" to `axis` does.
glm::dvec3 aligned(const glm::dvec3& v, const glm::dvec3& axis) {
  if (axis.z >= 0.9999) {
    return v;
  }
  if (axis.z <= -0.9999) {
    return turned(v, {0.0, 1.0, 0.0}, std::numbers::pi);
  }
  return turned(v, glm::normalize(glm::cross(up, axis)), std::acos(axis.z));
}

/// Depth n <= 6 bounds the recursion.
void add_balls(Scene& scene, const Directions& directions, std::uint32_t n, const glm::dvec3& center,
               double radius, const glm::dvec3& axis) {
  add_sphere(scene, center, radius, 1);
  if (n == 0) {
    return;
  }
  for (const glm::dvec3& direction : directions) {
    const glm::dvec3 way = aligned(direction, axis);
    add_balls(scene, directions, n - 1, center + radius * (1.0 + 1.0 / 3.0) * way, radius / 3.0, way);
  }
}

}  // namespace

Scene make_balls(std::uint32_t n) {
  Scene scene = make_scene({2.1, 1.3, 1.7}, {0.0, 0.0, 0.0}, up);
  constexpr std::array<glm::dvec3, 3> lights = {glm::dvec3{4.0, 3.0, 2.0}, glm::dvec3{1.0, -4.0, 4.0},
                                                glm::dvec3{-3.0, 1.0, 5.0}};
  set_lights(scene, lights);
  const std::uint32_t floor = add_material(scene, make_material("floor", {1.0, 0.75, 0.33}, 0.8));
  add_material(scene, make_material("balls", {1.0, 0.9, 0.7}, 0.5, 0.5, 0.5, 37.0));
  add_square(scene, {{{12.0, 12.0, -0.5}, {-12.0, 12.0, -0.5}, {-12.0, -12.0, -0.5}, {12.0, -12.0, -0.5}}},
             floor);
  add_balls(scene, directions_of_children(), n, {0.0, 0.0, 0.0}, 0.5, up);
  return scene;
}

}  // namespace marti::scenes::spd
