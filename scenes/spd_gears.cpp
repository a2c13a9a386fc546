// SPD gears(n): n x n x n meshing gears of 36 teeth over a ground square; 146 n^3 + 1 polygons.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "scenes/polygon.h"
#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

constexpr int teeth = 36;
constexpr double edge = 0.1;  // depth of the teeth, in gear radii

struct GearPlace {
  glm::dvec2 center;
  double radius;
  double top;
  double thickness;
  double phase;
};

/// The outline of a gear, counter-clockwise: four corners a tooth.
std::vector<glm::dvec2> outline_of(const GearPlace& place) {
  constexpr double pitch = 2.0 * std::numbers::pi / teeth;
  constexpr std::array<std::pair<double, double>, 4> tooth = {std::pair{-0.19, 0.995}, std::pair{0.19, 0.995},
                                                              std::pair{0.3, 1.0 - edge},
                                                              std::pair{0.7, 1.0 - edge}};
  std::vector<glm::dvec2> outline;
  outline.reserve(tooth.size() * teeth);
  for (int i = 0; i < teeth; ++i) {
    for (const auto& [offset, reach] : tooth) {
      const double angle = place.phase + (i + offset) * pitch;
      outline.push_back(place.center + reach * place.radius * glm::dvec2(std::cos(angle), std::sin(angle)));
    }
  }
  return outline;
}

class GearBuilder {
 public:
  explicit GearBuilder(Scene& scene) : scene_(scene) {}

  void add(const GearPlace& place, std::uint32_t material) {
    const std::vector<glm::dvec2> outline = outline_of(place);
    const auto first = static_cast<std::uint32_t>(scene_.positions.size());
    const auto count = static_cast<std::uint32_t>(outline.size());
    for (const double z : {place.top, place.top - place.thickness}) {
      for (const glm::dvec2& p : outline) {
        scene_.positions.emplace_back(p.x, p.y, z);
      }
    }
    // The same triangulation is used for both faces, so that top and bottom match.
    const auto cut = triangulate(outline);
    for (const auto& [a, b, c] : cut) {
      add_triangle(first + a, first + b, first + c, material);
    }
    ++scene_.polygons;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t j = (i + 1) % count;
      add_triangle(first + i, first + count + i, first + count + j, material);
      add_triangle(first + count + j, first + j, first + i, material);
      ++scene_.polygons;
    }
    for (const auto& [a, b, c] : cut) {
      add_triangle(first + count + c, first + count + b, first + count + a, material);
    }
    ++scene_.polygons;
  }

 private:
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
    scene_.triangles.push_back({{a, b, c}, material, static_cast<std::uint32_t>(scene_.polygons)});
  }
  Scene& scene_;
};

Material gear_material(std::uint32_t ix, std::uint32_t iy, std::uint32_t iz) {
  const auto channel = [](double phase) { return 0.01 + phase - std::floor(phase); };
  Material material;
  material.name = "gear " + std::to_string(ix) + " " + std::to_string(iy) + " " + std::to_string(iz);
  material.color = {channel((3.0 * ix + 2.0 * iy + iz + 1.0) * 5.0 / 7.0),
                    channel((3.0 * iy + 2.0 * iz + ix + 1.0) * 3.0 / 7.0),
                    channel((3.0 * iz + 2.0 * ix + iy + 1.0) * 2.0 / 7.0)};
  material.color /= std::max({material.color.r, material.color.g, material.color.b});
  if ((4 * ix + 2 * iy + iz) % 5 == 0) {
    material.diffuse = 0.2;
    material.transmission = 0.8;
    material.ior = 1.1;
  }
  return material;
}

}  // namespace

Scene make_gears(std::uint32_t n) {
  Scene scene = make_scene({-1.1, -2.1, 2.6}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
  constexpr std::array<glm::dvec3, 5> lights = {glm::dvec3{2.0, 4.0, 4.0}, glm::dvec3{-2.0, 4.0, 3.0},
                                                glm::dvec3{2.0, -2.5, 2.5}, glm::dvec3{-1.0, -4.0, 2.0},
                                                glm::dvec3{-1.111, -2.121, 2.626}};
  set_lights(scene, lights);
  scene.materials.push_back(make_material("ground", {1.0, 0.85, 0.7}, 0.3, 0.6, 0.3, 37.0));
  add_square(scene, {{{-2.0, -2.0, 0.0}, {2.0, -2.0, 0.0}, {2.0, 2.0, 0.0}, {-2.0, 2.0, 0.0}}}, 0);
  GearBuilder builder(scene);

  const double count = n;
  const double radius = 1.0 / (count - (count - 1.0) * edge / 2.0);
  const double step = radius * (2.0 - edge);
  for (std::uint32_t iz = 0; iz < n; ++iz) {
    for (std::uint32_t iy = 0; iy < n; ++iy) {
      for (std::uint32_t ix = 0; ix < n; ++ix) {
        GearPlace place;
        place.center = glm::dvec2(-1.0 + radius) + step * glm::dvec2(ix, iy);
        place.radius = radius;
        place.top = 1.0 - iz / count;
        place.thickness = std::min(0.1, 1.0 / (2.0 * count));
        place.phase = std::numbers::pi * ((ix + iy + iz) % 2) / teeth;
        scene.materials.push_back(gear_material(ix, iy, iz));
        builder.add(place, static_cast<std::uint32_t>(scene.materials.size() - 1));
      }
    }
  }
  return scene;
}

}  // namespace marti::scenes::spd
