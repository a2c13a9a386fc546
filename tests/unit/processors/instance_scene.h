// A scene whose instances are kept.
#pragma once

#include <cstdint>

#include <glm/gtc/matrix_transform.hpp>

#include "program_scenes.h"
#include "scenes/procedural.h"

namespace marti::processors::test {

/// A teapot with normals that stands in many places, over a floor.
inline scenes::Scene many_teapots() {
  scenes::Scene pot = scenes::make_procedural("teapot:2");
  const auto pot_triangles = static_cast<std::uint32_t>(pot.triangles.size());
  scenes::Scene scene;
  scene.camera = pot.camera;
  scene.lights = pot.lights;
  scene.materials = pot.materials;
  scene.materials[0].reflection = 0.3;
  add_floor(scene, -1.0, 40.0, 0);
  scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
  const auto floor = static_cast<std::uint32_t>(scene.triangles.size());
  const auto vertices = static_cast<std::uint32_t>(scene.positions.size());
  pot.normals.resize(pot.positions.size(), glm::dvec3(0.0));
  scene.positions.insert(scene.positions.end(), pot.positions.begin(), pot.positions.end());
  scene.normals.insert(scene.normals.end(), pot.normals.begin(), pot.normals.end());
  for (scenes::Triangle triangle : pot.triangles) {
    for (std::uint32_t& vertex : triangle.vertex) {
      vertex += vertices;
    }
    scene.triangles.push_back(triangle);
  }
  scene.meshes = {{0, floor}, {floor, pot_triangles}};
  scene.instances.emplace_back();
  for (int i = 0; i < 25; ++i) {
    const glm::dvec3 axis(0.3, 0.2 * i, 1.0);
    const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), 0.7 * i, glm::normalize(axis)));
    scenes::InstancePlace& place = scene.instances.emplace_back();
    place.mesh = 1;
    place.linear = turn * glm::dmat3(i % 3 == 0 ? -0.4 : 0.4);
    place.linear[1] *= 1.0 + 0.05 * i;
    place.shift = {2.5 * (i % 5 - 2), 2.5 * (i / 5 - 2), 0.2 * (i % 4)};
  }
  scenes::number_instances(scene);
  return scene;
}

}  // namespace marti::processors::test
