// glTF files whose meshes are compressed: by other programs, and by the libraries' own encoders, which gives
// the mesh back; broken ones; and what is said when marti was built without a library.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "loaded_scene.h"
#include "random_mesh.h"
#include "scenes/gltf.h"
#include "tests/unit/processors/program_scenes.h"
#include "text_scene.h"

#ifdef MARTI_DRACO
#include <draco/compression/expert_encode.h>
#include <draco/core/encoder_buffer.h>
#include <draco/mesh/mesh.h>
#endif
#ifdef MARTI_MESHOPT
#include <meshoptimizer.h>
#endif

namespace marti::scenes {
namespace {

using nlohmann::json;
using test::says;
using testing::corner;
using testing::GltfFile;
using testing::load_gltf;
using testing::RandomMesh;
using testing::SceneFolder;

const std::filesystem::path files = MARTI_COMPRESSED_SCENES;
constexpr const char* meshopt_extension = "EXT_meshopt_compression";
constexpr const char* draco_extension = "KHR_draco_mesh_compression";

std::string refusal(const std::filesystem::path& path) {
  return test::user_error_of([&] { static_cast<void>(load_gltf(path, {}, {})); });
}

using Corners = std::array<std::array<double, 3>, 3>;

// The triangles in an order that does not depend on their own, nor on the corner that each begins with.
[[maybe_unused]] std::vector<Corners> sorted_corners(const Scene& scene) {
  std::vector<Corners> all;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 p = corner(scene, t, i);
      corners[i] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.push_back(corners);
  }
  std::sort(all.begin(), all.end());
  return all;
}

// Nothing of the format is checked here: the accessors still have their bytes, so no library is needed.
TEST(GltfCompressed, AnExtensionWithoutItsLibraryIsRefusedWithTheReason) {
#ifndef MARTI_DRACO
  EXPECT_TRUE(says(refusal(files / "draco.glb"), "without the library Draco"));
  EXPECT_TRUE(says(refusal(files / "draco_not_required.glb"), "without the library Draco"));
#endif
#ifndef MARTI_MESHOPT
  EXPECT_TRUE(says(refusal(files / "meshopt.glb"), "without the library meshoptimizer"));
#endif
  const SceneFolder folder;
  GltfFile file = GltfFile::square();
  file.json["extensionsRequired"] = {"KHR_nothing"};
  EXPECT_TRUE(
      says(refusal(file.write_glb(folder.outside(), "a.glb")), "\"KHR_nothing\", which is not supported"));
}

// The view says nothing of how it is compressed, and the file has data that could be taken for uncompressed.
TEST(GltfCompressed, ViewsOfBytesThatAreNotThereAreRefused) {
  const SceneFolder folder;
  GltfFile file = GltfFile::square();
  file.json["extensionsUsed"] = {meshopt_extension};
  file.json["buffers"] = {
      {{"byteLength", file.bin.size()}, {"extensions", {{meshopt_extension, {{"fallback", true}}}}}}};
  const std::string message = refusal(file.write_glb(folder.outside(), "a.glb"));
  EXPECT_TRUE(says(message, "compressed by the extension EXT_meshopt_compression")) << message;
}

#ifdef MARTI_MESHOPT

TEST(Meshopt, AFileOfGltfpackHasTheTrianglesOfItsUncompressedTwin) {
  const Scene plain = load_gltf(files / "quantized.glb", {}, {});
  const Scene compressed = load_gltf(files / "meshopt.glb", {}, {});
  EXPECT_EQ(sorted_corners(plain), sorted_corners(compressed));
}

// The mesh with its two views compressed; `mode` is that of the indices.
GltfFile with_meshopt(const RandomMesh& mesh, const char* mode, bool exponents = false) {
  GltfFile file = mesh.gltf();
  const std::size_t vertices = mesh.vertices();
  const std::size_t corners = mesh.indices.size();
  std::vector<float> values = mesh.positions;
  if (exponents) {
    meshopt_encodeFilterExp(values.data(), vertices, 12, 24, mesh.positions.data());
  }
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(vertices, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), values.data(), vertices, 12));
  const std::size_t first = packed.size();
  const bool sequence = std::string(mode) == "INDICES";
  packed.resize(first + (sequence ? meshopt_encodeIndexSequenceBound(corners, vertices)
                                  : meshopt_encodeIndexBufferBound(corners, vertices)));
  const std::vector<unsigned> indices(mesh.indices.begin(), mesh.indices.end());
  const std::size_t second =
      sequence
          ? meshopt_encodeIndexSequence(packed.data() + first, packed.size() - first, indices.data(), corners)
          : meshopt_encodeIndexBuffer(packed.data() + first, packed.size() - first, indices.data(), corners);
  file.bin.assign(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(first + second));
  file.json["extensionsUsed"] = {meshopt_extension};
  file.json["extensionsRequired"] = {meshopt_extension};
  const std::size_t raw = vertices * 12;
  file.json["buffers"] = json::array(
      {{{"byteLength", file.bin.size()}},
       {{"byteLength", raw + 2 * corners}, {"extensions", {{meshopt_extension, {{"fallback", true}}}}}}});
  json of_vertices = {{"buffer", 0},      {"byteOffset", 0},   {"byteLength", first},
                      {"byteStride", 12}, {"count", vertices}, {"mode", "ATTRIBUTES"}};
  if (exponents) {
    of_vertices["filter"] = "EXPONENTIAL";
  }
  const json of_indices = {{"buffer", 0},     {"byteOffset", first}, {"byteLength", second},
                           {"byteStride", 2}, {"count", corners},    {"mode", mode}};
  file.json["bufferViews"] = json::array({{{"buffer", 1},
                                           {"byteLength", raw},
                                           {"byteStride", 12},
                                           {"extensions", {{meshopt_extension, of_vertices}}}},
                                          {{"buffer", 1},
                                           {"byteOffset", raw},
                                           {"byteLength", 2 * corners},
                                           {"extensions", {{meshopt_extension, of_indices}}}}});
  return file;
}

TEST(Meshopt, GivesTheMeshExactly) {
  const SceneFolder folder;
  const RandomMesh mesh(5, 7);
  const Scene plain = folder.open("plain.glb", mesh.gltf().glb());
  const processors::test::Built built(plain, "octree");
  const processors::program::RenderOptions options{.width = 40, .height = 40, .max_depth = 2};
  for (const bool exponents : {false, true}) {
    const Scene exact = folder.open("exact.glb", with_meshopt(mesh, "INDICES", exponents).glb());
    ASSERT_EQ(exact.triangles.size(), plain.triangles.size());
    for (std::size_t t = 0; t < plain.triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_EQ(corner(exact, t, i), corner(plain, t, i));
      }
    }
    EXPECT_EQ(processors::test::Built(exact, "octree").render(options).hit_hash,
              built.render(options).hit_hash);
  }
  const Scene turned = folder.open("turned.glb", with_meshopt(mesh, "TRIANGLES").glb());
  EXPECT_EQ(sorted_corners(turned), sorted_corners(plain));
  // A .gltf file, whose buffers have names.
  GltfFile file = with_meshopt(mesh, "TRIANGLES");
  file.json["buffers"][0]["uri"] = "data.bin";
  folder.write("data.bin", file.bin);
  EXPECT_EQ(sorted_corners(folder.open("a.gltf", file.json.dump())), sorted_corners(plain));
}

TEST(Meshopt, EveryFaultIsRefused) {
  struct Fault {
    const char* place;  // in the extension of the first view
    json value;
    const char* reason;
  };
  const std::vector<Fault> faults = {
      {"buffer", 9, "are in buffer 9, but the file has 2"},
      {"buffer", -1, "need a whole number as buffer"},
      {"buffer", "0", "have a buffer that is no number"},
      {"buffer", 1, "their buffer is too short: 0 bytes"},
      {"byteOffset", 1U << 30U, "their buffer is too short"},
      {"byteLength", 1U << 30U, "their buffer is too short"},
      {"byteLength", 1.5, "byteLength is 1.5, which is no whole number"},
      {"byteLength", 10, "are damaged"},
      {"byteOffset", 5, "are damaged"},
      {"count", 0, "are 0 elements"},
      {"count", 200000000, "are 200000000 elements; 1 to"},
      {"count", 4000000000U, "count is 4000000000, which is no whole number of at most"},
      {"count", 63, "are 756 bytes when decompressed, but the view has 768"},
      {"byteStride", 0, "which the mode ATTRIBUTES does not allow"},
      {"byteStride", 6, "which the mode ATTRIBUTES does not allow"},
      {"byteStride", 260, "which the mode ATTRIBUTES does not allow"},
      {"byteStride", 24, "are 1536 bytes when decompressed"},
      {"mode", "POINTS", "are of the mode 'POINTS'"},
      {"mode", 3, "have a mode that is no text"},
      {"mode", "TRIANGLES", "which the mode TRIANGLES does not allow"},
      {"filter", "OCTAHEDRAL", "have the filter 'OCTAHEDRAL'"},
      {"filter", "COLOR", "have the filter 'COLOR'"}};
  const SceneFolder folder;
  const GltfFile good = with_meshopt(RandomMesh(5, 7), "TRIANGLES");
  for (const Fault& fault : faults) {
    GltfFile file = good;
    const auto at = json::json_pointer("/bufferViews/0/extensions/EXT_meshopt_compression");
    file.json[at][fault.place] = fault.value;
    const std::string message = folder.refusal("a.glb", file.glb());
    EXPECT_TRUE(message.starts_with("a.glb: buffer view 0: its compressed data ") ||
                message.starts_with("a.glb: it is no valid glTF 2.0: /bufferViews/0/extensions/"))
        << fault.place << " " << fault.value << ": " << message;
    EXPECT_TRUE(says(message, fault.reason)) << message;
  }
  FileOptions tight;
  tight.memory = sim::MemoryBudget(good.glb().size() * 2 + 20'000);
  GltfFile large = good;
  large.json["bufferViews"][0]["byteLength"] = 12'000'000;
  large.json["bufferViews"][0]["extensions"][meshopt_extension]["count"] = 1'000'000;
  EXPECT_TRUE(says(folder.refusal("a.glb", large.glb(), tight), "its decompressed data take"));
}

#endif

#ifdef MARTI_DRACO

TEST(Draco, FilesOfAnotherProgramAreRead) {
  for (const char* name : {"draco.glb", "draco_not_required.glb"}) {
    const Scene scene = load_gltf(files / name, {}, {});
    ASSERT_EQ(scene.triangles.size(), 128U) << name;
    // The height field that was compressed: u (1 - u) v (1 - v) over a grid of 9 x 9.
    for (const glm::dvec3& p : scene.positions) {
      const double u = std::round(p.x * 8.0) / 8.0;
      const double v = std::round(p.y * 8.0) / 8.0;
      EXPECT_NEAR(p.x, u, 1e-3);
      EXPECT_NEAR(p.y, v, 1e-3);
      EXPECT_NEAR(p.z, u * (1.0 - u) * v * (1.0 - v), 1e-3);
    }
    EXPECT_NEAR(bounds_of(scene).hi.z, 0.0625, 1e-3);
  }
}

// The mesh compressed by Draco: with 0 bits the floats are kept.
GltfFile with_draco(const RandomMesh& from, int method, int bits) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(from.vertices()));
  draco::GeometryAttribute position;
  position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int id = mesh.AddAttribute(position, true, static_cast<std::uint32_t>(from.vertices()));
  for (std::uint32_t i = 0; i < from.vertices(); ++i) {
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                          from.positions.data() + 3 * std::size_t{i});
  }
  for (std::size_t i = 0; i < from.indices.size(); i += 3) {
    mesh.AddFace({draco::PointIndex(from.indices[i]), draco::PointIndex(from.indices[i + 1]),
                  draco::PointIndex(from.indices[i + 2])});
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  if (bits > 0) {
    encoder.SetAttributeQuantization(id, bits);
  }
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  GltfFile file = from.gltf();
  file.bin.assign(buffer.data(), buffer.size());
  file.json["bufferViews"] = json::array({{{"buffer", 0}, {"byteLength", buffer.size()}}});
  file.json["accessors"][0].erase("bufferView");
  file.json["accessors"][1].erase("bufferView");
  file.json["extensionsUsed"] = {draco_extension};
  file.json["extensionsRequired"] = {draco_extension};
  file.primitive()["extensions"] = {
      {draco_extension,
       {{"bufferView", 0}, {"attributes", {{"POSITION", mesh.attribute(id)->unique_id()}}}}}};
  return file;
}

TEST(Draco, GivesTheMeshExactlyWithoutQuantization) {
  const SceneFolder folder;
  for (const std::uint32_t seed : {6U, 7U}) {
    const RandomMesh mesh(seed, 7);
    const std::vector<Corners> plain = sorted_corners(folder.open("plain.glb", mesh.gltf().glb()));
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
      const Scene scene = folder.open("draco.glb", with_draco(mesh, method, 0).glb());
      EXPECT_EQ(sorted_corners(scene), plain) << method;
    }
  }
}

TEST(Draco, KeepsWithinTheQuantization) {
  const SceneFolder folder;
  const RandomMesh mesh(8, 7);
  const Scene plain = folder.open("plain.glb", mesh.gltf().glb());
  for (const int bits : {8, 11, 14}) {
    const Scene scene =
        folder.open("draco.glb", with_draco(mesh, draco::MESH_SEQUENTIAL_ENCODING, bits).glb());
    ASSERT_EQ(scene.triangles.size(), plain.triangles.size());
    // Draco divides the largest extent, of at most 8, into 2^bits - 1 steps and rounds to the nearest.
    const double step = 8.0 / (std::pow(2.0, bits) - 1.0);
    double worst = 0.0;
    for (const glm::dvec3& p : plain.positions) {
      double nearest = 1e9;
      for (const glm::dvec3& q : scene.positions) {
        nearest =
            std::min(nearest, std::max({std::abs(p.x - q.x), std::abs(p.y - q.y), std::abs(p.z - q.z)}));
      }
      worst = std::max(worst, nearest);
    }
    EXPECT_LE(worst, 0.5 * step + 1e-5) << bits;
    EXPECT_GT(worst, 0.0) << bits;
  }
}

TEST(Draco, EveryFaultIsRefused) {
  struct Fault {
    const char* place;
    json value;
    const char* reason;
  };
  const std::string extension = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  const std::vector<Fault> faults = {
      {"/accessors/1/count", 3, "have 98 triangles, but the accessor of its indices is for 1"},
      {"/accessors/1/count", 4, "are for 4 corners"},
      {"/accessors/1/count", 4000000000U, "are for 4000000000 corners"},
      {"/accessors/0/count", 63, "have 64 vertices, but the accessors of its attributes have 63"},
      {"/accessors/0/count", 0, "are for 0 vertices"},
      {"/accessors/0/count", 4000000000U, "are for 4000000000 vertices"},
      {"/accessors/0/componentType", 5123, "of component type 5123"},
      {"/accessors/0/type", "VEC2", "whose accessor has 2 of component type 5126"},
      {"/accessors/1/componentType", 5126, "unsigned scalars are needed"},
      {"/meshes/0/primitives/0/mode", 5, "lists of triangles only"},
      {"/EXT/bufferView", 7, "buffer view 7"},
      {"/EXT/bufferView", "0", "need a whole number as \"bufferView\""},
      {"/EXT/attributes", 3, "name no attributes"},
      {"/EXT/attributes", json::object(), "name no attributes"},
      {"/EXT/attributes", {{"NORMAL", 0}}, "are for 0 vertices"},
      {"/EXT/attributes/POSITION", 5, "have no attribute 5 for \"POSITION\""},
      {"/EXT/attributes/POSITION", -1, "need a whole number as \"POSITION\""},
      {"/bufferViews/0/byteLength", 20, "compressed data "},
      {"/bufferViews/0/byteOffset", 1, "too short"}};
  const SceneFolder folder;
  const GltfFile good = with_draco(RandomMesh(6, 7), draco::MESH_EDGEBREAKER_ENCODING, 11);
  ASSERT_EQ(folder.refusal("a.glb", good.glb()), "no UserError");
  for (const Fault& fault : faults) {
    GltfFile file = good;
    std::string place = fault.place;
    if (place.starts_with("/EXT")) {
      place = extension + place.substr(4);
    }
    file.json[json::json_pointer(place)] = fault.value;
    const std::string message = folder.refusal("a.glb", file.glb());
    EXPECT_EQ(message.rfind("a.glb: ", 0), 0U) << fault.place << ": " << message;
    EXPECT_TRUE(says(message, fault.reason)) << fault.place << " " << fault.value << ": " << message;
  }
  GltfFile file = good;
  file.bin[0] = 'X';
  EXPECT_TRUE(says(folder.refusal("a.glb", file.glb()), "do not begin as Draco's do"));
  file = good;
  file.bin[7] = 0;
  EXPECT_TRUE(says(folder.refusal("a.glb", file.glb()), "are no mesh"));
  file = good;
  file.bin[8] = 9;
  EXPECT_TRUE(says(folder.refusal("a.glb", file.glb()), "an unknown method, 9"));
  file = good;
  file.bin[6] = 1;
  EXPECT_TRUE(says(folder.refusal("a.glb", file.glb()), "version before 2.2"));
  FileOptions tight;
  tight.memory = sim::MemoryBudget(good.glb().size() * 2 + 20'000);
  EXPECT_TRUE(says(folder.refusal("a.glb", good.glb(), tight), "its compressed data take"));
}

// Any one byte changed, and cut off anywhere: refused or read, without harm.
TEST(Draco, DamagedDataDoNoHarm) {
  const SceneFolder folder;
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const GltfFile good = with_draco(RandomMesh(9, 3), method, 8);
    std::size_t refused = 0;
    for (std::size_t at = 0; at < good.bin.size(); ++at) {
      for (const int flip : {0x01, 0xff}) {
        GltfFile file = good;
        file.bin[at] = static_cast<char>(file.bin[at] ^ flip);
        refused += folder.refusal("a.glb", file.glb()) == "no UserError" ? 0U : 1U;
      }
      GltfFile file = good;
      file.json["bufferViews"][0]["byteLength"] = std::max<std::size_t>(at, 1);
      EXPECT_NE(folder.refusal("a.glb", file.glb()), "no UserError") << at;
    }
    EXPECT_GT(refused, 10U);
  }
}

#endif

}  // namespace
}  // namespace marti::scenes
