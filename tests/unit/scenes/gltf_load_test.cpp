// The scenes that the glTF reader makes of valid files.
#include "scenes/gltf.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "gltf_file.h"
#include "scenes/open.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/scenes/loaded_scene.h"

namespace marti::scenes {
namespace {

using testing::corner;
using testing::GltfFile;
using testing::has_note;
using testing::load_gltf;

class GltfLoad : public ::testing::Test {
 protected:
  Scene load(const GltfFile& file, const FileOptions& options = {}, const ImageDecoder& decode = {}) {
    return load_gltf(file.write_glb(directory_.path(), "scene.glb"), options, decode);
  }
  std::string refusal(const GltfFile& file, const FileOptions& options = {}) {
    return test::user_error_of([&] { static_cast<void>(load(file, options)); });
  }
  test::TemporaryDirectory directory_;
};

/// The corners of all triangles in order.
std::vector<glm::dvec3> corners(const Scene& scene) {
  std::vector<glm::dvec3> list;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      list.push_back(corner(scene, t, i));
    }
  }
  return list;
}

glm::dvec3 normal_of(const Scene& scene, std::size_t t) {
  return glm::normalize(
      glm::cross(corner(scene, t, 1) - corner(scene, t, 0), corner(scene, t, 2) - corner(scene, t, 0)));
}

TEST_F(GltfLoad, BothContainersAndAllKindsOfBuffers) {
  GltfFile file = GltfFile::square();
  const Scene binary = load(file);
  const Scene text = load_gltf(file.write_gltf(directory_.path(), "a b.gltf"), {}, {});
  EXPECT_EQ(corners(binary), corners(text));
  EXPECT_EQ(binary.triangles.size(), 2U);
  EXPECT_EQ(binary.polygons, 2U);
  EXPECT_EQ(binary.positions.size(), 4U);
  EXPECT_EQ(corner(binary, 1, 1), glm::dvec3(1, 1, 0));
}

TEST_F(GltfLoad, NodesPlaceMeshes) {
  GltfFile file = GltfFile::square();
  // A parent that turns by 90 degrees about z and moves; a child that scales; a matrix node beside them.
  const double h = std::sqrt(0.5);
  file.json["nodes"] = {{{"translation", {10, 0, 0}}, {"rotation", {0, 0, h, h}}, {"children", {1}}},
                        {{"mesh", 0}, {"scale", {2, 3, 1}}},
                        {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}};
  file.json["scenes"] = {{{"nodes", {0, 2}}}};
  const Scene scene = load(file);
  ASSERT_EQ(scene.triangles.size(), 4U);
  EXPECT_LT(glm::length(corner(scene, 0, 2) - glm::dvec3(10 - 3, 2, 0)), 1e-12);
  EXPECT_EQ(corner(scene, 2, 2), glm::dvec3(6, 7, 7));
}

TEST_F(GltfLoad, NormalsFollowTheInverseTranspose) {
  GltfFile file = GltfFile::square();
  const float h = std::sqrt(0.5F);
  // A plane tilted about y: positions on z = x, normal (-1, 0, 1) / sqrt 2.
  file = GltfFile();
  const int positions = file.add_positions({0, 0, 0, 1, 0, 1, 1, 1, 1});
  const int normals = file.add_positions({-h, 0, h, -h, 0, h, -h, 0, h});
  file.json["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}}}}}};
  for (const std::vector<double>& scale :
       {std::vector<double>{4, 1, 0.5}, {-1, 1, 1}, {1, -2, 3}, {-1, -1, -1}, {1e-3, 1e3, 1}}) {
    file.json["nodes"][0]["scale"] = scale;
    const Scene scene = load(file);
    ASSERT_EQ(scene.normals.size(), 3U);
    const glm::dvec3 facet = normal_of(scene, 0);
    EXPECT_LT(glm::length(scene.normals[0] - facet), 1e-6)
        << "shading and facet normals agree, mirrored or not";
  }
  file.json["nodes"][0]["scale"] = {1, 1, 0};
  EXPECT_LT(glm::length(load(file).normals[0] - glm::dvec3(0, 0, 1)), 1e-6) << "flattened, but still a plane";
}

TEST_F(GltfLoad, StripsAndFansAreLists) {
  const std::vector<float> ring = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0};
  const auto with = [&](int mode, const std::vector<std::uint16_t>& indices) {
    GltfFile file;
    const int positions = file.add_positions(ring);
    file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"mode", mode}}}}}};
    if (!indices.empty()) {
      file.primitive()["indices"] = file.add_indices(indices);
    }
    return corners(load(file));
  };
  const auto strip_as_list = with(4, {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4});
  EXPECT_EQ(with(5, {}), strip_as_list);
  EXPECT_EQ(with(5, {0, 1, 2, 3, 4, 5}), strip_as_list);
  const auto fan_as_list = with(4, {1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0});
  EXPECT_EQ(with(6, {}), fan_as_list);
  EXPECT_EQ(with(6, {0, 1, 2, 3, 4, 5}), fan_as_list);
  EXPECT_EQ(with(4, {}), with(4, {0, 1, 2, 3, 4, 5}));
}

TEST_F(GltfLoad, EveryComponentTypeOfIndicesAndAttributes) {
  const Scene reference = load(GltfFile::square());
  GltfFile file = GltfFile::square();
  file.primitive()["indices"] = file.add_accessor<std::uint8_t>({0, 1, 2, 0, 2, 3}, 5121, "SCALAR", 1);
  EXPECT_EQ(corners(load(file)), corners(reference));
  file.primitive()["indices"] = file.add_accessor<std::uint32_t>({0, 1, 2, 0, 2, 3}, 5125, "SCALAR", 1);
  EXPECT_EQ(corners(load(file)), corners(reference));

  const auto normalized = [&](int accessor) {
    file.json["accessors"][static_cast<std::size_t>(accessor)]["normalized"] = true;
    file.primitive()["attributes"]["POSITION"] = accessor;
    return corner(load(file), 0, 2);
  };
  EXPECT_EQ(normalized(file.add_accessor<std::uint8_t>({0, 0, 0, 255, 0, 0, 255, 51, 0, 0, 255, 0}, 5121,
                                                       "VEC3", 3)),
            glm::dvec3(1, 0.2, 0));
  EXPECT_EQ(normalized(file.add_accessor<std::int8_t>({0, 0, 0, 127, 0, 0, -127, -128, 0, 0, 1, 0}, 5120,
                                                      "VEC3", 3)),
            glm::dvec3(-1, -1, 0));
  EXPECT_EQ(normalized(file.add_accessor<std::uint16_t>({0, 0, 0, 1, 0, 0, 65535, 13107, 0, 0, 9, 0}, 5123,
                                                        "VEC3", 3)),
            glm::dvec3(1, 0.2, 0));
  EXPECT_EQ(normalized(file.add_accessor<std::int16_t>({0, 0, 0, 1, 0, 0, 32767, -32768, 0, 0, 9, 0}, 5122,
                                                       "VEC3", 3)),
            glm::dvec3(1, -1, 0));
  const int plain = file.add_accessor<std::int16_t>({0, 0, 0, 7, 0, 0, 700, -9, 0, 0, 9, 0}, 5122, "VEC3", 3);
  file.primitive()["attributes"]["POSITION"] = plain;
  EXPECT_EQ(corner(load(file), 0, 2), glm::dvec3(700, -9, 0));
}

TEST_F(GltfLoad, StridesAndOffsets) {
  GltfFile file = GltfFile::square();
  // Interleaved: junk, x y z, junk per vertex, and one leading element that is skipped.
  std::vector<float> raw(5, 99.0F);
  for (const float v : {0.F, 0.F, 2.F, 0.F, 2.F, 2.F, 0.F, 2.F}) {
    if (raw.size() % 5 == 0) {
      raw.push_back(99.0F);
    }
    raw.push_back(v);
    if (raw.size() % 5 == 3) {
      raw.insert(raw.end(), {0.0F, 99.0F});
    }
  }
  const int positions = file.add_accessor(raw, 5126, "VEC3", 5);
  file.json["accessors"].back()["byteOffset"] = 24;
  file.json["accessors"].back()["count"] = 4;
  file.json["bufferViews"].back()["byteStride"] = 20;
  file.primitive()["attributes"]["POSITION"] = positions;
  const Scene scene = load(file);
  EXPECT_EQ(corner(scene, 0, 2), glm::dvec3(2, 2, 0));
  EXPECT_EQ(corner(scene, 1, 2), glm::dvec3(0, 2, 0));
}

TEST_F(GltfLoad, SparseAccessors) {
  GltfFile file = GltfFile::square();
  const int indices = file.add_view<std::uint8_t>({2, 3});
  const int values = file.add_view<float>({5, 6, 7, 8, 9, 10});
  const nlohmann::json sparse = {{"count", 2},
                                 {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                 {"values", {{"bufferView", values}}}};
  file.json["accessors"][0]["sparse"] = sparse;
  Scene scene = load(file);
  EXPECT_EQ(corner(scene, 0, 1), glm::dvec3(1, 0, 0));
  EXPECT_EQ(corner(scene, 0, 2), glm::dvec3(5, 6, 7));
  EXPECT_EQ(corner(scene, 1, 2), glm::dvec3(8, 9, 10));
  file.json["accessors"][0].erase("bufferView");
  scene = load(file);
  EXPECT_EQ(corner(scene, 0, 1), glm::dvec3(0, 0, 0)) << "without a view all else is zero";
  EXPECT_EQ(corner(scene, 0, 2), glm::dvec3(5, 6, 7));
}

TEST_F(GltfLoad, Materials) {
  GltfFile file = GltfFile::square();
  file.json["materials"] = {
      {{"name", "glass"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 1, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0}}},
       {"emissiveFactor", {0.1, 0.2, 0.3}},
       {"extensions",
        {{"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
         {"KHR_materials_ior", {{"ior", 2.0}}},
         {"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}}}}}};
  file.primitive()["material"] = 0;
  const Material glass = load(file).materials.at(0);
  const double f0 = 1.0 / 9.0;
  EXPECT_EQ(glass.color, glm::dvec3(0.5, 0.25, 1));
  EXPECT_EQ(glass.ior, 2.0);
  EXPECT_NEAR(glass.reflection, f0, 1e-12);
  EXPECT_NEAR(glass.transmission, 0.75 * (1 - f0), 1e-12);
  EXPECT_NEAR(glass.diffuse, 0.25 * (1 - f0), 1e-12);
  EXPECT_LT(glm::length(glass.emission - glm::dvec3(1, 2, 3)), 1e-12);
  EXPECT_EQ(glass.specular_color, glm::dvec3(1.0));

  // For any factors the weights are in range and share out the light.
  for (const double m : {0.0, 0.3, 1.0}) {
    for (const double r : {0.0, 0.4, 1.0}) {
      file.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = m;
      file.json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = r;
      const Material material = load(file).materials.at(0);
      EXPECT_NEAR(material.diffuse + material.reflection + material.transmission, 1.0, 1e-12);
      EXPECT_GE(material.shininess, 1.0);
      EXPECT_LE(material.shininess, 1e5);
    }
  }
  const Material by_default = load(GltfFile::square()).materials.at(0);
  EXPECT_EQ(by_default.color, glm::dvec3(1.0));
  EXPECT_EQ(by_default.diffuse, 1.0) << "glTF's default is rough";
}

TEST_F(GltfLoad, TexturesComeFromTheDecoder) {
  GltfFile file = GltfFile::square();
  const int image = file.add_view<std::uint8_t>({'P', 'I', 'C'});
  const int uvs = file.add_accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 2);
  file.json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}, {"name", "picture"}}};
  file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 10497}}};
  file.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  file.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  file.primitive()["material"] = 0;
  file.primitive()["attributes"]["TEXCOORD_0"] = uvs;
  std::string seen;
  const ImageDecoder decoder = [&seen](std::span<const std::byte> bytes, std::string_view name) {
    seen.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    seen += name;
    const std::vector<std::uint8_t> grey = {1, 2};
    return texture_from_samples("ignored", 2, 1, 1, grey);
  };
  const Scene scene = load(file, {}, decoder);
  EXPECT_EQ(seen, "PICpicture");
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_TRUE(scene.textures[0].srgb);
  EXPECT_FALSE(scene.textures[0].repeat_u);
  EXPECT_TRUE(scene.textures[0].repeat_v);
  EXPECT_EQ(scene.materials[0].texture, 0U);
  ASSERT_EQ(scene.uvs.size(), scene.positions.size());
  EXPECT_EQ(scene.uvs[scene.triangles[0].vertex[2]], glm::dvec2(1, 1));
  EXPECT_NE(refusal(file).find("no image decoder"), std::string::npos);

  file.json["images"][0] = {{"uri", "picture.png"}};
  FileOptions strict;
  strict.strict = true;
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(load(file, strict, decoder)); }).find("picture.png"),
            std::string::npos);
  testing::write_bytes(directory_.path() / "picture.png", "FILE");
  static_cast<void>(load(file, {}, decoder));
  EXPECT_EQ(seen, "FILEpicture.png");
  const ImageDecoder failing = [](std::span<const std::byte>, std::string_view) -> Texture {
    throw sim::UserError("not a picture");
  };
  EXPECT_NE(
      test::user_error_of([&] { static_cast<void>(load(file, strict, failing)); }).find("not a picture"),
      std::string::npos);
}

TEST_F(GltfLoad, Lights) {
  GltfFile file = GltfFile::square();
  file.json["extensionsUsed"] = {"KHR_lights_punctual"};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 8}, {"range", 4}},
      {{"type", "directional"}, {"intensity", 3}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}}};
  const double h = std::sqrt(0.5);
  const auto light_node = [](int light) {
    return nlohmann::json{{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}};
  };
  file.json["nodes"].push_back(light_node(0));
  file.json["nodes"].back()["translation"] = {1, 2, 3};
  file.json["nodes"].push_back(light_node(1));
  file.json["nodes"].back()["rotation"] = {-h, 0, 0, h};  // -z turned to -y
  file.json["nodes"].push_back(light_node(2));
  file.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const Scene scene = load(file);
  ASSERT_EQ(scene.lights.size(), 3U);
  EXPECT_EQ(scene.lights[0].kind, LightKind::point);
  EXPECT_EQ(scene.lights[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.lights[0].color, glm::dvec3(8, 4, 0));
  EXPECT_EQ(scene.lights[0].range, 4.0);
  EXPECT_TRUE(scene.lights[0].inverse_square);
  EXPECT_EQ(scene.lights[1].kind, LightKind::directional);
  EXPECT_LT(glm::length(scene.lights[1].direction - glm::dvec3(0, -1, 0)), 1e-12);
  EXPECT_FALSE(scene.lights[1].inverse_square);
  EXPECT_EQ(scene.lights[2].kind, LightKind::spot);
  EXPECT_NEAR(scene.lights[2].cos_inner_cone, std::cos(0.1), 1e-12);
  EXPECT_NEAR(scene.lights[2].cos_outer_cone, std::cos(0.5), 1e-12);
  EXPECT_FALSE(has_note(scene, "no light"));
  EXPECT_EQ(scene.ambient, glm::dvec3(0.0));
}

TEST_F(GltfLoad, CamerasAreChosen) {
  GltfFile file = GltfFile::square();
  file.json["cameras"] = {
      {{"type", "orthographic"},
       {"name", "flat"},
       {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 9}, {"znear", 1}}}},
      {{"type", "perspective"}, {"name", "near"}, {"perspective", {{"yfov", 0.5}, {"znear", 1}}}},
      {{"type", "perspective"}, {"name", "far"}, {"perspective", {{"yfov", 0.25}, {"znear", 1}}}}};
  file.json["nodes"].push_back({{"camera", 0}});
  file.json["nodes"].push_back({{"camera", 1}, {"translation", {0, 0, 3}}});
  file.json["nodes"].push_back({{"camera", 2}, {"translation", {0, 0, 1e6}}});
  file.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
  EXPECT_EQ(load(file).camera.vertical_fov, 0.5) << "the first perspective one";
  EXPECT_EQ(load(file).camera.eye, glm::dvec3(0, 0, 3));
  const glm::dvec3 forward = load(file).camera.at - load(file).camera.eye;
  EXPECT_EQ(glm::normalize(forward), glm::dvec3(0, 0, -1));
  FileOptions options;
  options.camera = "far";
  EXPECT_EQ(load(file, options).camera.vertical_fov, 0.25);
  options.camera = "1";
  EXPECT_EQ(load(file, options).camera.vertical_fov, 0.5);
  options.camera = "flat";
  EXPECT_NE(refusal(file, options).find("orthographic"), std::string::npos);
  options.camera = "neer";
  EXPECT_NE(refusal(file, options).find("did you mean"), std::string::npos);
  options.camera = "3";
  EXPECT_NE(refusal(file, options).find("no camera '3'"), std::string::npos);
  file.json["scenes"][0]["nodes"] = {0, 1};
  options.camera = "far";
  EXPECT_NE(refusal(file, options).find("no node"), std::string::npos);
  EXPECT_TRUE(has_note(load(file), "frames it")) << "an orthographic camera is no perspective one";
}

TEST_F(GltfLoad, AFramedViewSeesTheWholeScene) {
  GltfFile file = GltfFile::square();
  file.json["nodes"][0]["translation"] = {1e5, -3, 7};
  file.json["nodes"][0]["scale"] = {50, 1, 1};
  const Scene scene = load(file);
  EXPECT_TRUE(has_note(scene, "camera"));
  EXPECT_TRUE(has_note(scene, "no light"));
  EXPECT_EQ(scene.lights.size(), 1U);
  const glm::dvec3 forward = glm::normalize(scene.camera.at - scene.camera.eye);
  for (const glm::dvec3& p : scene.positions) {
    const double cosine = glm::dot(glm::normalize(p - scene.camera.eye), forward);
    EXPECT_GT(cosine, std::cos(scene.camera.vertical_fov / 2.0));
  }
}

TEST_F(GltfLoad, ScenesAreChosen) {
  GltfFile file = GltfFile::square();
  file.json["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  file.json["scenes"] = {{{"nodes", {0}}, {"name", "left"}}, {{"nodes", {1}}, {"name", "right"}}};
  file.json["scene"] = 1;
  EXPECT_EQ(bounds_of(load(file)).lo.x, 5.0);
  FileOptions options;
  options.scene = "left";
  EXPECT_EQ(bounds_of(load(file, options)).lo.x, 0.0);
  options.scene = "1";
  EXPECT_EQ(bounds_of(load(file, options)).lo.x, 5.0);
  options.scene = "middle";
  EXPECT_NE(refusal(file, options).find("no scene 'middle'"), std::string::npos);
  file.json.erase("scenes");
  file.json.erase("scene");
  EXPECT_EQ(load(file).triangles.size(), 4U) << "without scenes all nodes count";
}

TEST_F(GltfLoad, BadTrianglesAreLeftOutAndCounted) {
  std::vector<float> positions;
  for (int i = 0; i < 10'000; ++i) {
    const auto x = static_cast<float>(i);
    positions.insert(positions.end(), {x, 0, 0, x + 1, 0, 0, x, 1, 0});
  }
  positions[9 * 1234 + 4] = NAN;
  GltfFile file;
  const int accessor = file.add_positions(positions);
  file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", accessor}}}}}}}};
  const Scene scene = load(file);
  EXPECT_EQ(scene.triangles.size(), 9999U);
  EXPECT_EQ(scene.polygons, 10000U);
  EXPECT_EQ(scene.triangles[1234].polygon, 1235U);
  EXPECT_TRUE(has_note(scene, "1 of 10000 triangles"));
  for (const glm::dvec3& p : scene.positions) {
    ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
  }
}

TEST_F(GltfLoad, DegenerateTrianglesAreKeptAndCounted) {
  GltfFile file = GltfFile::square();
  file.primitive()["indices"] = file.add_indices({0, 1, 2, 0, 0, 1, 2, 0, 1});
  const Scene scene = load(file);
  EXPECT_EQ(scene.triangles.size(), 3U);
  EXPECT_TRUE(has_note(scene, "1 of 3 triangles have no area"));
  const SceneFacts facts = facts_of(scene);
  EXPECT_EQ(facts.degenerate_triangles, 1U);
  EXPECT_EQ(facts.duplicate_triangles, 1U);
  EXPECT_EQ(facts.distinct_positions, 3U);
  EXPECT_NE(describe(scene).find("degenerate triangles: 1"), std::string::npos);
}

TEST_F(GltfLoad, WhatIsLeftOutIsNoted) {
  GltfFile file = GltfFile::square();
  file.json["extensionsUsed"] = {"KHR_materials_clearcoat"};
  file.json["animations"] = nlohmann::json::array();
  nlohmann::json lines = file.primitive();
  lines["mode"] = 1;
  file.json["meshes"][0]["primitives"].push_back(lines);
  const Scene scene = load(file);
  EXPECT_TRUE(has_note(scene, "KHR_materials_clearcoat"));
  EXPECT_TRUE(has_note(scene, "1 primitives of points or lines"));
}

TEST(OpenScene, ChoosesByTheEndOfTheName) {
  const test::TemporaryDirectory directory;
  static_cast<void>(GltfFile::square().write_glb(directory.path(), "Model.GLB"));
  OpenOptions options;
  options.base_directory = directory.path();
  EXPECT_EQ(open_scene("Model.GLB", options, {}).triangles.size(), 2U);
  EXPECT_EQ(open_scene((directory.path() / "Model.GLB").string(), {}, {}).triangles.size(), 2U);
  EXPECT_EQ(open_scene("tetra:1", options, {}).triangles.size(), 4U);
  EXPECT_NE(test::user_error_of([&] {
              static_cast<void>(open_scene("other.gltf", options, {}));
            }).find("other.gltf"),
            std::string::npos);
  options.file.camera = "x";
  EXPECT_NE(
      test::user_error_of([&] { static_cast<void>(open_scene("tetra:1", options, {})); }).find("tetra:1"),
      std::string::npos);
  options.file.camera.clear();
  options.file.time = 2;
  EXPECT_NE(test::user_error_of([&] {
              static_cast<void>(open_scene("tetra:1", options, {}));
            }).find("no animation plays"),
            std::string::npos);
  EXPECT_EQ(open_animated("tetra:1", options, {}).at(2.0).triangles.size(), 4U);
  options.file.animation = "walk";
  EXPECT_NE(test::user_error_of([&] {
              static_cast<void>(open_animated("tetra:1", options, {}));
            }).find("no animations"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::scenes
