// SPD rings(n): interlocking pentagonal rings of cylinders and spheres, six to a cluster, in a pyramid of n
// layers before a wall; 5 n (n + 1) (2 n + 1) spheres and as many cylinders.
#include <array>
#include <cmath>
#include <numbers>

#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

using Pentagon = std::array<glm::dvec3, 5>;

constexpr double thickness = 0.07412;
constexpr double scale = 1.0 / (1.0 + thickness);

std::array<Pentagon, 6> pentagons() {
  constexpr double pi = std::numbers::pi;
  std::array<Pentagon, 6> all;
  for (std::size_t i = 0; i < 5; ++i) {
    const double angle = 2.0 * pi * static_cast<double>(i) / 5.0;
    all[0][i] = scale * glm::dvec3(std::cos(angle), std::sin(angle), 0.0);
  }
  const double tilt = 2.0 * std::acos(std::cos(pi / 3.0) / std::sin(pi / 5.0));
  for (std::size_t k = 1; k < 6; ++k) {
    for (std::size_t i = 0; i < 5; ++i) {
      const glm::dvec3 tilted = turned(all[0][i], {1.0, 0.0, 0.0}, tilt);
      all[k][i] = turned(tilted, {0.0, 0.0, 1.0}, pi * (2.0 * static_cast<double>(k - 1) + 1.0) / 5.0);
    }
  }
  return all;
}

}  // namespace

Scene make_rings(std::uint32_t n) {
  const double s = 1.0 / std::sin(std::numbers::pi / 8.0);
  const glm::dvec3 eye(-1.0, -s, 0.5);
  Scene scene = make_scene(eye, eye + glm::dvec3(0.0, 1.0, 0.0), {0.0, 0.0, 1.0});
  const std::array<glm::dvec3, 3> lights = {glm::dvec3{3.0, -s, 3.0}, glm::dvec3{-4.0, -s, 1.0},
                                            glm::dvec3{2.0, -s, -4.0}};
  set_lights(scene, lights);
  const std::uint32_t wall = add_material(scene, make_material("wall", {1.0, 1.0, 1.0}, 1.0));
  constexpr std::array<glm::dvec3, 6> colors = {glm::dvec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1},
                                                glm::dvec3{0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
  for (std::size_t k = 0; k < colors.size(); ++k) {
    add_material(scene, make_material("ring " + std::to_string(k), colors[k], 0.5, 0.2, 0.3, 37.0));
  }
  const double back = s * (n + 1.0);
  const double half = 1.01 * (back + s) * std::tan(std::numbers::pi / 8.0);
  add_square(scene,
             {{{-1.0 - half, back, 0.5 - half},
               {-1.0 + half, back, 0.5 - half},
               {-1.0 + half, back, 0.5 + half},
               {-1.0 - half, back, 0.5 + half}}},
             wall);
  const std::array<Pentagon, 6> rings = pentagons();
  for (std::uint32_t layer = 0; layer < n; ++layer) {
    for (std::uint32_t i = 0; i <= layer; ++i) {
      for (std::uint32_t j = 0; j <= layer; ++j) {
        const glm::dvec3 center(2.0 * i - layer, s * (layer + 1.0), 2.0 * j - layer);
        for (std::size_t k = 0; k < rings.size(); ++k) {
          const auto material = static_cast<std::uint32_t>(1 + k);
          for (std::size_t p = 0; p < 5; ++p) {
            const glm::dvec3 here = center + rings[k][p];
            add_cylinder(scene, here, center + rings[k][(p + 4) % 5], thickness, material);
            add_sphere(scene, here, thickness, material);
          }
        }
      }
    }
  }
  return scene;
}

}  // namespace marti::scenes::spd
