// A scene that is written as glTF and read again.
#include <cmath>
#include <cstring>
#include <filesystem>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "scenes/gltf_export.h"
#include "scenes/open.h"
#include "scenes/procedural.h"
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

/// Rounded to 32 bits, by way of memory: g++ 12 at -O3 drops both conversions of dvec3(vec3(v)).
glm::dvec3 narrow(const glm::dvec3& v) {
  glm::dvec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    const volatile auto rounded = static_cast<float>(v[axis]);
    result[axis] = rounded;
  }
  return result;
}

void expect_same_view(const Camera& a, const Camera& b) {
  const ImagePlane p = a.image_plane(64, 48);
  const ImagePlane q = b.image_plane(64, 48);
  EXPECT_EQ(p.origin, q.origin);
  EXPECT_LT(glm::length(p.corner - q.corner), 1e-14);
  EXPECT_LT(glm::length(p.step_x - q.step_x), 1e-15);
  EXPECT_LT(glm::length(p.step_y - q.step_y), 1e-15);
}

void expect_same_scene(const Scene& scene, const Scene& copy) {
  ASSERT_EQ(scene.triangles.size(), copy.triangles.size());
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = scene.triangles[t].vertex[i];
      const std::uint32_t b = copy.triangles[t].vertex[i];
      ASSERT_EQ(narrow(scene.positions[a]), copy.positions[b]);
      if (!scene.normals.empty()) {
        ASSERT_LT(glm::length(scene.normals[a] - copy.normals[b]), 1e-7);
      }
      if (!scene.uvs.empty()) {
        ASSERT_EQ(glm::dvec2(glm::vec2(scene.uvs[a])), copy.uvs[b]);
      }
    }
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
    EXPECT_LT(glm::length(a.color - b.color), 1e-15);
    EXPECT_EQ(a.inverse_square, b.inverse_square);
    EXPECT_EQ(a.range, b.range);
    EXPECT_EQ(a.position, b.position);
    if (a.kind != LightKind::point) {
      EXPECT_LT(glm::length(a.direction - b.direction), 1e-15);
    }
    if (a.kind == LightKind::spot) {
      EXPECT_NEAR(a.cos_inner_cone, b.cos_inner_cone, 1e-14);
      EXPECT_NEAR(a.cos_outer_cone, b.cos_outer_cone, 1e-14);
    }
  }
  expect_same_view(scene.camera, copy.camera);
  EXPECT_EQ(scene.background, copy.background);
  EXPECT_EQ(scene.ambient, copy.ambient);
}

TEST(RoundTrip, ProceduralScenes) {
  const test::TemporaryDirectory directory;
  for (const char* spec : {"teapot:5", "gears:2", "tetra:3", "teapot:3:pot"}) {
    const Scene scene = make_procedural(spec);
    const auto path = directory.path() / "scene.glb";
    export_glb(scene, path);
    const Scene copy = load_gltf(path, {}, {});
    expect_same_scene(scene, copy);
    EXPECT_EQ(facts_of(copy).distinct_positions, facts_of(scene).distinct_positions) << "seams stay closed";
    EXPECT_TRUE(copy.notes.empty()) << copy.notes.front();
    // Once narrowed, nothing changes any more.
    export_glb(copy, directory.path() / "again.glb");
    const Scene again = load_gltf(directory.path() / "again.glb", {}, {});
    EXPECT_EQ(copy.positions, again.positions);
  }
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
  scene.uvs.resize(scene.positions.size(), glm::dvec2(0.25, 0.75));
  scene.materials[0].texture = 0;
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
  EXPECT_EQ(narrow(scene.positions[scene.triangles[1].vertex[0]]),
            sorted.positions[sorted.triangles[0].vertex[0]]);
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
  scene.textures.push_back({"t", 1, 1, true, true, true, {{0, 0, 0, 0}}, nullptr});
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
