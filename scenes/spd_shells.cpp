// SPD shells(n): a sea shell of 180 * 2^n + 1 overlapping spheres along a logarithmic spiral.
#include <cmath>
#include <numbers>

#include "scenes/spd.h"

namespace marti::scenes::spd {

Scene make_shells(std::uint32_t n) {
  Scene scene = make_scene({-6.0, -60.0, 35.0}, {0.0, 8.0, -15.0}, {0.0, 0.0, 1.0});
  const glm::dvec3 light(-100.0, -100.0, 100.0);
  set_lights(scene, {&light, 1});
  const std::uint32_t shell =
      add_material(scene, make_material("shell", {1.0, 0.8, 0.4}, 0.8, 0.2, 0.2, 37.0));
  const auto steps = static_cast<std::int32_t>(180U << n);
  for (std::int32_t i = -2 * steps / 3; i <= steps / 3; ++i) {
    const double angle = 18.0 * std::numbers::pi * i / steps;
    const double r = std::exp(0.15 * angle);
    add_sphere(scene, {r * std::sin(angle), r * std::cos(angle), -2.0 * r}, r, shell);
  }
  return scene;
}

}  // namespace marti::scenes::spd
