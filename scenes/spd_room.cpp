// room(n): a teapot(n) and a mirrored ball in a closed room, lit by a panel in the ceiling. Not one of the
// Standard Procedural Databases, none of which has an emissive surface: a room in the manner of C. M. Goral,
// K. E. Torrance, D. P. Greenberg, B. Battaile, "Modeling the interaction of light between diffuse surfaces",
// SIGGRAPH 1984, where half of the light in the shadows comes from the walls.
#include <utility>

#include "scenes/spd.h"

namespace marti::scenes::spd {

Scene make_room(std::uint32_t n) {
  // The teapot stands on z = 0 and is 6.4 wide and 3.2 high.
  Scene scene = make_teapot(n, false);
  scene.camera = make_scene({0.0, 14.0, 4.4}, {0.0, 0.0, 3.2}, {0.0, 0.0, 1.0}).camera;
  scene.lights.clear();
  scene.ambient = glm::dvec3(0.0);
  scene.background = glm::dvec3(0.0);
  scene.materials[0] = make_material("pot", {1.0, 0.5, 0.1}, 0.75);
  const std::uint32_t white = add_material(scene, make_material("white", {1.0, 1.0, 1.0}, 0.75));
  const std::uint32_t red = add_material(scene, make_material("red", {0.85, 0.15, 0.1}, 0.75));
  const std::uint32_t green = add_material(scene, make_material("green", {0.15, 0.7, 0.2}, 0.75));
  const std::uint32_t mirror = add_material(scene, make_material("mirror", {1.0, 1.0, 1.0}, 0.05, 0.9));
  Material light = make_material("panel", {0.0, 0.0, 0.0}, 0.0);
  light.emission = {14.0, 13.0, 11.0};
  const std::uint32_t panel = add_material(scene, std::move(light));

  // Corners turn counter-clockwise seen from inside the room.
  constexpr double x = 6.0;
  constexpr double back = -5.0;
  constexpr double front = 15.0;
  constexpr double z = 8.0;
  add_square(scene, {{{-x, back, 0.0}, {x, back, 0.0}, {x, front, 0.0}, {-x, front, 0.0}}}, white);
  add_square(scene, {{{-x, back, 0.0}, {-x, back, z}, {x, back, z}, {x, back, 0.0}}}, white);
  add_square(scene, {{{x, front, 0.0}, {x, front, z}, {-x, front, z}, {-x, front, 0.0}}}, white);
  add_square(scene, {{{-x, front, 0.0}, {-x, front, z}, {-x, back, z}, {-x, back, 0.0}}}, green);
  add_square(scene, {{{x, back, 0.0}, {x, back, z}, {x, front, z}, {x, front, 0.0}}}, red);
  // The panel is a part of the ceiling: light from just below a ceiling would make its own surroundings
  // noisy.
  const auto add_ceiling = [&scene](double left, double right, double near, double far,
                                    std::uint32_t material) {
    add_square(scene, {{{left, far, z}, {right, far, z}, {right, near, z}, {left, near, z}}}, material);
  };
  add_ceiling(-2.0, 2.0, 0.0, 3.0, panel);
  add_ceiling(-x, -2.0, back, front, white);
  add_ceiling(2.0, x, back, front, white);
  add_ceiling(-2.0, 2.0, back, 0.0, white);
  add_ceiling(-2.0, 2.0, 3.0, front, white);
  scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));  // flat walls
  add_sphere(scene, {-3.6, 3.4, 1.2}, 1.2, mirror);
  return scene;
}

}  // namespace marti::scenes::spd
