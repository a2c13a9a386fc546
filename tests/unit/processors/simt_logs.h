// Logs for machines of SIMT nodes: small images with every kind of visit, ray and shader step.
#pragma once

#include <vector>

#include "instance_scene.h"
#include "processors/program/work_log.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "tests/support/random_machine.h"

namespace marti::processors::test {

/// Triangles about the origin that reflect, refract and scatter, one kind of them with a texture.
inline scenes::Scene glass_and_pictures() {
  marti::test::Random random(17);
  const auto number = [&random](int size) {
    return static_cast<double>(marti::test::pick(random, -100 * size, 100 * size)) / 100.0;
  };
  const auto point = [&number](int size) { return glm::dvec3(number(size), number(size), number(size)); };
  scenes::Scene scene = looking_down(6.0);
  scene.background = {0.1, 0.2, 0.3};
  for (int i = 0; i < 4; ++i) {
    scenes::Material& material = scene.materials.emplace_back();
    material.diffuse = i == 1 ? 0.0 : 0.6;
    material.reflection = i == 0 ? 0.0 : 0.3;
    material.transmission = i == 2 ? 0.6 : 0.0;
    material.ior = 1.33;
  }
  scene.materials[3].texture = 0;
  scenes::Texture& texture = scene.textures.emplace_back();
  texture.width = 6;
  texture.height = 5;
  texture.texels.assign(30, {200, 100, 50, 255});
  for (std::uint32_t i = 0; i < 70; ++i) {
    const glm::dvec3 at = point(2);
    for (std::uint32_t k = 0; k < 3; ++k) {
      scene.positions.push_back(at + point(1));
      scene.normals.emplace_back(0.0);
      scene.uvs.emplace_back(number(2), number(2));
    }
    scene.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, i % 4, i});
  }
  scene.lights.emplace_back().position = {1.0, 2.0, 5.0};
  scene.lights.emplace_back().position = {-4.0, 1.0, 4.0};
  return scene;
}

/// These triangles with holes in half of them.
inline scenes::Scene with_holes() {
  scenes::Scene scene = glass_and_pictures();
  for (std::size_t texel = 0; texel < 30; texel += 1 + texel % 3) {
    scene.textures[0].texels[texel][3] = 0;
  }
  for (const std::size_t material : {1, 3}) {
    scene.materials[material].texture = 0;
    scene.materials[material].cut_out = {1.0, 0.5, 0};
  }
  return scene;
}

/// The work logs of small renderings; of bounding volume hierarchies, and of others.
inline std::vector<program::WorkLog> simt_logs(std::uint32_t width, std::uint32_t height,
                                               bool entered = true) {
  std::vector<program::WorkLog> logs;
  const auto add = [&](scenes::Scene scene, std::string_view kind, program::RenderOptions options = {},
                       accel::BvhNodeKind node = accel::BvhNodeKind::two) {
    accel::StructureOptions structure;
    structure.bvh.node = node;
    Built built(std::move(scene), kind);
    built.structure = accel::make_structure(kind, built.triangles, structure);
    options.width = width;
    options.height = height;
    options.record = true;
    options.entered = options.ray_words = entered;
    options.meets = entered && kind == "bvh" && built.triangles->cut_outs() == nullptr &&
                    built.triangles->instances().empty();
    if (options.max_depth == program::RenderOptions{}.max_depth) {
      options.max_depth = 3;
    }
    logs.push_back(*built.render(options).log);
  };
  add(glass_and_pictures(), "octree");
  add(glass_and_pictures(), "bvh");
  add(glass_and_pictures(), "bvh", {}, accel::BvhNodeKind::eight_quantised);
  add(scenes::make_procedural("balls:1"), "grid");
  add(scenes::make_procedural("jacks:2"), "bvh", {}, accel::BvhNodeKind::eight);
  add(scenes::make_procedural("jacks:2"), "bvh", {.order = accel::WalkOrder::breadth_first},
      accel::BvhNodeKind::four);
  add(glass_and_pictures(), "bvh", {.order = accel::WalkOrder::treelet_first, .treelet_records = 6},
      accel::BvhNodeKind::eight);
  add(scenes::make_procedural("lattice:1"), "bsp", {.samples = 2});
  add(scenes::make_procedural("room:2"), "bvh", {.integrator = program::Integrator::path},
      accel::BvhNodeKind::four);
  add(scenes::make_procedural("balls:0"), "none");
  add(with_holes(), "octree");
  add(with_holes(), "bvh", {.integrator = program::Integrator::path});
  add(with_holes(), "bvh", {.order = accel::WalkOrder::treelet_first, .treelet_records = 6},
      accel::BvhNodeKind::eight);
  add(many_teapots(), "bvh", {}, accel::BvhNodeKind::four);
  add(many_teapots(), "bvh", {.integrator = program::Integrator::path}, accel::BvhNodeKind::eight_quantised);
  scenes::Scene far = scenes::make_procedural("tetra:4");
  far.camera.eye = far.camera.at + 4.0 * (far.camera.eye - far.camera.at);
  add(far, "octree", {.voxel_cut = 1.0});
  return logs;
}

}  // namespace marti::processors::test
