// A scene that is written as glTF and read again.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "accel/structure.h"
#include "gltf_file.h"
#include "loaded_scene.h"
#include "processors/program/render.h"
#include "scenes/gltf_export.h"
#include "scenes/open.h"
#include "scenes/procedural.h"
#include "scenes/tessellate.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::scenes {
namespace {

using testing::load_gltf;

// A codec without loss for the tests: sizes, then texels.
std::vector<std::byte> encode(const Texture& texture) {
  std::vector<std::byte> bytes(8 + 4 * texture.texels.size());
  std::memcpy(bytes.data(), &texture.width, 4);
  std::memcpy(bytes.data() + 4, &texture.height, 4);
  std::memcpy(bytes.data() + 8, texture.texels.data(), 4 * texture.texels.size());
  return bytes;
}

Texture decode(std::span<const std::byte> bytes, std::string_view /*name*/) {
  Texture texture;
  std::memcpy(&texture.width, bytes.data(), 4);
  std::memcpy(&texture.height, bytes.data() + 4, 4);
  texture.texels.resize(std::size_t{texture.width} * texture.height);
  std::memcpy(texture.texels.data(), bytes.data() + 8, 4 * texture.texels.size());
  return texture;
}

/// Every value but the notes, the names and the numbers of polygons, which files do not keep.
void expect_same_scene(const Scene& scene, const Scene& copy) {
  EXPECT_EQ(scene.positions, copy.positions);
  EXPECT_EQ(scene.normals, copy.normals);
  EXPECT_EQ(scene.uvs, copy.uvs);
  ASSERT_EQ(scene.triangles.size(), copy.triangles.size());
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    ASSERT_EQ(scene.triangles[t].vertex, copy.triangles[t].vertex);
    const Material& m = scene.materials[scene.triangles[t].material];
    const Material& n = copy.materials[copy.triangles[t].material];
    ASSERT_EQ(m.name, n.name);
    ASSERT_EQ(m.color, n.color);
    ASSERT_EQ(m.specular_color, n.specular_color);
    ASSERT_EQ(m.emission, n.emission);
    ASSERT_EQ(m.diffuse, n.diffuse);
    ASSERT_EQ(m.reflection, n.reflection);
    ASSERT_EQ(m.transmission, n.transmission);
    ASSERT_EQ(m.ior, n.ior);
    ASSERT_EQ(m.highlight, n.highlight);
    ASSERT_EQ(m.shininess, n.shininess);
    ASSERT_EQ(m.texture == no_texture, n.texture == no_texture);
  }
  ASSERT_EQ(scene.lights.size(), copy.lights.size());
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& a = scene.lights[i];
    const Light& b = copy.lights[i];
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.color, b.color);
    EXPECT_EQ(a.inverse_square, b.inverse_square);
    EXPECT_EQ(a.range, b.range);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.direction, b.direction);
    if (a.kind == LightKind::spot) {
      EXPECT_EQ(a.cos_inner_cone, b.cos_inner_cone);
      EXPECT_EQ(a.cos_outer_cone, b.cos_outer_cone);
    }
  }
  EXPECT_EQ(scene.lights_are_all, copy.lights_are_all);
  EXPECT_EQ(scene.camera.eye, copy.camera.eye);
  EXPECT_EQ(scene.camera.at, copy.camera.at);
  EXPECT_EQ(scene.camera.up, copy.camera.up);
  EXPECT_EQ(scene.camera.vertical_fov, copy.camera.vertical_fov);
  EXPECT_EQ(scene.background, copy.background);
  EXPECT_EQ(scene.ambient, copy.ambient);
}

processors::program::Frame rendered(const Scene& scene, processors::program::Integrator integrator) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  return processors::program::render(scene, *triangles, *accel::make_structure("bvh", triangles),
                                     {.width = 32, .height = 32, .integrator = integrator, .samples = 4}, 1);
}

double mean_difference(const processors::program::Image& a, const processors::program::Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const glm::vec3 difference = glm::abs(a.pixels[i] - b.pixels[i]);
    sum += double{difference.x} + difference.y + difference.z;
  }
  return sum / (3.0 * static_cast<double>(a.pixels.size()));
}

// What becomes triangles is another scene, whose image may differ by as much as a circle from 24 chords.
TEST(RoundTrip, EveryRecipeIsTheSameSceneInEveryBit) {
  const test::TemporaryDirectory directory;
  const auto path = directory.path() / "scene.glb";
  for (const ProceduralScene& kind : procedural_scenes()) {
    const std::uint32_t size = std::min(kind.minimum_size + 1, kind.maximum_size);
    const std::string spec = std::string(kind.name) + ":" + std::to_string(size);
    SCOPED_TRACE(spec);
    const Scene recipe = make_procedural(spec);
    if (recipe.gaussians != nullptr) {
      EXPECT_NE(test::user_error_of([&] { export_glb(recipe, path); }).find("glTF has no Gaussians"),
                std::string::npos);
      continue;
    }
    Scene scene = recipe;
    tessellate(scene);
    export_glb(recipe, path);
    const Scene copy = load_gltf(path, {}, {});
    expect_same_scene(scene, copy);
    EXPECT_TRUE(copy.notes.empty()) << copy.notes.front();
    for (const auto integrator :
         {processors::program::Integrator::whitted, processors::program::Integrator::path}) {
      const processors::program::Frame first = rendered(recipe, integrator);
      const processors::program::Frame again = rendered(copy, integrator);
      if (recipe.quadrics.empty()) {
        EXPECT_EQ(first.rays.traced, again.rays.traced);
        EXPECT_EQ(first.rays.hit, again.rays.hit);
        EXPECT_EQ(first.image.pixels, again.image.pixels);
      } else {
        EXPECT_LT(mean_difference(first.image, again.image), 0.02);
      }
    }
  }
}

// Another program may have moved what it has read, and kept the rest.
TEST(RoundTrip, ExactValuesCountOnlyWhereTheyAgree) {
  const test::TemporaryDirectory directory;
  const auto path = directory.path() / "scene.glb";
  Scene scene = make_procedural("tetra:1");
  export_glb(scene, path);
  std::string bytes = testing::read_bytes(path);
  const auto place_of = [&bytes](const std::string& text) {
    const std::size_t at = bytes.find(text);
    EXPECT_NE(at, std::string::npos) << text;
    return at;
  };
  const auto bytes_of = [](const glm::vec3& v) {
    return std::string(reinterpret_cast<const char*>(&v), sizeof v);
  };
  const glm::vec3 corner(scene.positions[0]);
  bytes.replace(place_of(bytes_of(corner)), sizeof corner, bytes_of({5.0F, corner.y, 6.0F}));
  const std::string at = "\"at\":[";
  bytes[place_of(at) + at.size()] = '7';
  testing::write_bytes(path, bytes);
  const Scene copy = load_gltf(path, {}, {});
  EXPECT_EQ(copy.positions[0], glm::dvec3(5.0, scene.positions[0].y, 6.0));
  EXPECT_EQ(copy.positions[1], scene.positions[1]);
  EXPECT_NE(copy.camera.at, scene.camera.at);
  const glm::dvec3 before = scene.camera.image_plane(3, 3).corner;
  EXPECT_LT(glm::length(copy.camera.image_plane(3, 3).corner - before), 1e-12);
}

TEST(RoundTrip, TexturesLightsAndManyMaterials) {
  const test::TemporaryDirectory directory;
  Scene scene = make_procedural("tetra:7");  // 16,384 triangles
  Texture texture;
  texture.name = "two";
  texture.width = 2;
  texture.height = 1;
  texture.repeat_v = false;
  texture.texels = {{1, 2, 3, 4}, {250, 251, 252, 253}};
  scene.textures.push_back(texture);
  scene.uvs.resize(scene.positions.size(), glm::dvec2(0.1, 0.75));
  scene.materials[0].texture = 0;
  scene.materials[0].cut_out = {0.75, 0.25, 0};
  scene.materials[0].emission = {3.0, 0.5, 0.0};
  scene.lights.push_back(
      {LightKind::spot, {1, 2, 3}, glm::normalize(glm::dvec3(1, -2, 0.5)), {9, 3, 1}, true, 7.0, 0.9, 0.4});
  scene.lights.push_back({LightKind::directional,
                          {0, 0, 0},
                          glm::normalize(glm::dvec3(-1, 0, 0.1)),
                          {0.2, 0.2, 0.2},
                          false,
                          0.0,
                          1.0,
                          0.7});
  const auto path = directory.path() / "scene.glb";
  export_glb(scene, path, encode);
  const Scene copy = load_gltf(path, {}, decode);
  expect_same_scene(scene, copy);
  ASSERT_EQ(copy.textures.size(), 1U);
  EXPECT_EQ(copy.textures[0].texels, texture.texels);
  EXPECT_TRUE(copy.textures[0].repeat_u);
  EXPECT_FALSE(copy.textures[0].repeat_v);

  // More runs of materials than primitives are wanted: sorted, but all there.
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].name = "other";
  for (std::size_t t = 0; t < scene.triangles.size(); t += 2) {
    scene.triangles[t].material = 1;
  }
  export_glb(scene, path, encode);
  const Scene sorted = load_gltf(path, {}, decode);
  EXPECT_EQ(sorted.triangles.size(), scene.triangles.size());
  EXPECT_EQ(sorted.materials.size(), 2U);
  EXPECT_EQ(scene.positions[scene.triangles[1].vertex[0]], sorted.positions[sorted.triangles[0].vertex[0]]);
}

TEST(RoundTrip, RefusesAndLeavesNoHalfFile) {
  const test::TemporaryDirectory directory;
  const auto refusal = [&](const Scene& scene, const std::filesystem::path& path) {
    return test::user_error_of([&] { export_glb(scene, path); });
  };
  const auto path = directory.path() / "scene.glb";
  EXPECT_NE(refusal(Scene{}, path).find("without triangles"), std::string::npos);
  Scene scene = make_procedural("tetra:1");
  EXPECT_NE(refusal(scene, directory.path() / "missing" / "scene.glb").find("missing"), std::string::npos);
  scene.textures.push_back({.name = "t", .width = 1, .height = 1, .texels = {{0, 0, 0, 0}}});
  EXPECT_NE(refusal(scene, path).find("no image encoder"), std::string::npos);
  scene.textures.clear();
  scene.positions[0].x = 1e39;
  EXPECT_NE(refusal(scene, path).find("too large"), std::string::npos);
  scene.positions[0].x = 0.0;
  scene.materials[0].name = "\xff\xfe";
  EXPECT_NE(refusal(scene, path).find("cannot be written"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(RoundTrip, DamagedOwnWeightsAreNoted) {
  const test::TemporaryDirectory directory;
  testing::GltfFile file = testing::GltfFile::square();
  file.json["materials"] = {{{"extras", {{"marti", {{"diffuse", 2.0}}}}}}};
  file.primitive()["material"] = 0;
  const Scene scene = load_gltf(file.write_glb(directory.path(), "a.glb"), {}, {});
  EXPECT_EQ(scene.materials[0].diffuse, 1.0);
  EXPECT_NE(describe(scene).find("own weights"), std::string::npos);
}

}  // namespace
}  // namespace marti::scenes
