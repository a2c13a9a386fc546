// large: a scene of 19,409 polygons, put together from others: gears(2) with its ground, a teapot(12) on top
// of the gears and another beside them, both without their boards.
//
// It stands in for the scene of "just over 19,000 polygons" of McNeill, Shah, Hebert, Lister and Grimsdale,
// "Performance of Space Subdivision Techniques in Ray Tracing" (Computer Graphics Forum 11(4), 1992), which
// the paper does not name. 1,169 + 2 * 9,120 is a sum that fits, not a reconstruction.
#include <array>

#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

/// Adds a scene's triangles and materials, rotated about z, scaled and moved.
void add_scene(Scene& scene, const Scene& other, double degrees, double scale, const glm::dvec3& place) {
  const auto first_vertex = static_cast<std::uint32_t>(scene.positions.size());
  const auto first_material = static_cast<std::uint32_t>(scene.materials.size());
  const auto turn = [degrees](const glm::dvec3& v) {
    return turned(v, {0.0, 0.0, 1.0}, degrees * 0.017453292519943295);
  };
  // A zero normal means the triangle's own.
  scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i < other.positions.size(); ++i) {
    scene.positions.push_back(place + scale * turn(other.positions[i]));
    scene.normals.push_back(other.normals.empty() ? glm::dvec3(0.0) : turn(other.normals[i]));
  }
  for (Triangle triangle : other.triangles) {
    for (std::uint32_t& vertex : triangle.vertex) {
      vertex += first_vertex;
    }
    triangle.material += first_material;
    triangle.polygon += static_cast<std::uint32_t>(scene.polygons);
    scene.triangles.push_back(triangle);
  }
  scene.materials.insert(scene.materials.end(), other.materials.begin(), other.materials.end());
  scene.polygons += other.polygons;
}

}  // namespace

Scene make_large() {
  Scene scene = make_scene({-2.2, -4.2, 2.9}, {0.0, -0.15, 0.65}, {0.0, 0.0, 1.0});
  constexpr std::array<glm::dvec3, 3> lights = {glm::dvec3{2.0, -3.5, 5.0}, glm::dvec3{-4.0, -3.0, 4.0},
                                                glm::dvec3{-1.0, 4.0, 6.0}};
  set_lights(scene, lights);
  add_scene(scene, make_gears(2), 0.0, 1.0, glm::dvec3(0.0));
  Scene teapot = make_teapot(12, false);
  add_scene(scene, teapot, 200.0, 0.28, {0.0, 0.0, 1.0});
  teapot.materials[0].color = {0.25, 0.5, 0.9};
  add_scene(scene, teapot, -35.0, 0.18, {-0.9, -1.5, 0.0});
  return scene;
}

}  // namespace marti::scenes::spd
