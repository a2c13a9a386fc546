// SPD sombrero(n): the height field cos(2 pi r) e^-r over a square, of w x w samples, w = 32 * 2^(n - 1);
// 2 (w - 1)^2 triangles. y is up.
#include <cmath>
#include <numbers>

#include "scenes/spd.h"

namespace marti::scenes::spd {

Scene make_sombrero(std::uint32_t n) {
  Scene scene = make_scene({0.0, 5.0, -8.0}, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  scene.camera.vertical_fov = 40.0 * std::numbers::pi / 180.0;
  const glm::dvec3 light(10.0, 10.0, -10.0);
  set_lights(scene, {&light, 1});
  add_material(scene, make_material("sombrero", {1.0, 0.1, 0.1}, 1.0));
  const std::uint32_t side = 32U << (n - 1);
  const auto coordinate = [side](std::uint32_t i) { return 8.0 * i / (side - 1) - 4.0; };
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = 0; i < side; ++i) {
      const double x = coordinate(i);
      const double z = coordinate(j);
      const double r = std::sqrt(x * x + z * z);
      scene.positions.emplace_back(x, std::cos(2.0 * std::numbers::pi * r) * std::exp(-r), z);
    }
  }
  for (std::uint32_t j = 0; j + 1 < side; ++j) {
    for (std::uint32_t i = 0; i + 1 < side; ++i) {
      const std::uint32_t a = j * side + i;
      // Counter-clockwise seen from above.
      scene.triangles.push_back(
          {{a, a + side, a + side + 1}, 0, static_cast<std::uint32_t>(scene.polygons++)});
      scene.triangles.push_back({{a + side + 1, a + 1, a}, 0, static_cast<std::uint32_t>(scene.polygons++)});
    }
  }
  return scene;
}

}  // namespace marti::scenes::spd
