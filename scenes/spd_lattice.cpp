// SPD lattice(n): spheres at the points of a cubic lattice joined by cylinders; (n + 1)^3 spheres and
// 3 n (n + 1)^2 cylinders.
#include <array>
#include <cmath>
#include <numbers>

#include "scenes/spd.h"

namespace marti::scenes::spd {

Scene make_lattice(std::uint32_t n) {
  const double count = n;
  const std::uint32_t middle = n / 2;
  const double x = (middle + 0.5) / count;
  Scene scene = make_scene({x, 1.0, 1.0 - 0.5 / count}, {x, -1.0, -1.0 - 0.5 / count}, {0.2, 1.0, 0.0});
  scene.camera.vertical_fov = std::numbers::pi / 3.0;
  constexpr std::array<glm::dvec3, 6> lights = {glm::dvec3{2.0, 0.5, 0.5}, glm::dvec3{-1.0, 0.5, 0.5},
                                                glm::dvec3{0.5, 2.0, 0.5}, glm::dvec3{0.5, -1.0, 0.5},
                                                glm::dvec3{0.5, 0.5, 2.0}, glm::dvec3{0.5, 0.5, -1.0}};
  set_lights(scene, lights);
  const std::uint32_t ball = add_material(scene, make_material("ball", {0.9, 0.9, 0.9}, 0.5, 0.5, 0.5, 37.0));
  constexpr std::array<glm::dvec3, 3> colors = {glm::dvec3{0.9, 0.1, 0.1}, {0.1, 0.9, 0.1}, {0.1, 0.1, 0.9}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    add_material(scene, make_material("rod " + std::to_string(axis), colors[axis], 0.99));
  }
  const double radius = 1.0 / (4.0 * count);
  // Rods begin just inside the spheres.
  const double hidden = 0.99 * radius * (1.0 - std::sqrt(0.25));
  for (std::uint32_t k = 0; k <= n; ++k) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      for (std::uint32_t i = 0; i <= n; ++i) {
        const std::array<std::uint32_t, 3> at = {i, j, k};
        const glm::dvec3 here = glm::dvec3(i, j, k) / count;
        add_sphere(scene, here, radius, ball);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (at[axis] < n) {
            glm::dvec3 from = here;
            glm::dvec3 to = here;
            const auto a = static_cast<int>(axis);
            from[a] += hidden;
            to[a] += 1.0 / count - hidden;
            add_cylinder(scene, from, to, radius / 4.0, static_cast<std::uint32_t>(1 + axis));
          }
        }
      }
    }
  }
  return scene;
}

}  // namespace marti::scenes::spd
