// SPD jacks(n): a jack of three rods with a ball at each of its six ends, and in its eight corners jacks of
// half the size, n deep; 9 (8^n - 1) / 7 primitives.
#include <numbers>

#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

/// Rotates the whole scene: first about x, then about y.
glm::dvec3 placed(const glm::dvec3& v) {
  constexpr double radians = std::numbers::pi / 180.0;
  return turned(turned(v, {1.0, 0.0, 0.0}, -30.0 * radians), {0.0, 1.0, 0.0}, -20.0 * radians);
}

/// Depth n <= 6 bounds the recursion.
void add_jacks(Scene& scene, std::uint32_t n, const glm::dvec3& center, double scale) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 arm(0.0);
    arm[axis] = 0.75 * scale;
    const glm::dvec3 from = placed(center - arm);
    const glm::dvec3 to = placed(center + arm);
    add_cylinder(scene, from, to, 0.75 * 0.1 * scale, 0);
    add_sphere(scene, from, 0.75 * 0.2 * scale, 0);
    add_sphere(scene, to, 0.75 * 0.2 * scale, 0);
  }
  if (n == 1) {
    return;
  }
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    glm::dvec3 way;
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = ((corner >> static_cast<unsigned>(axis)) & 1U) != 0 ? 0.5 : -0.5;
    }
    add_jacks(scene, n - 1, center + scale * way, 0.5 * scale);
  }
}

}  // namespace

Scene make_jacks(std::uint32_t n) {
  Scene scene = make_scene({0.0, 0.0, -8.0}, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  scene.camera.vertical_fov = 25.0 * std::numbers::pi / 180.0;
  scene.background = {0.2, 0.05, 0.2};
  const glm::dvec3 light(-10.0, 3.0, -20.0);
  set_lights(scene, {&light, 1});
  add_material(scene, make_material("jacks", {0.737, 0.561, 0.561}, 0.7, 0.7, 0.7, 37.0));
  add_jacks(scene, n, {0.0, 0.0, 0.0}, 1.0);
  return scene;
}

}  // namespace marti::scenes::spd
