// Broken and malicious glTF files: each must be refused with its path and a reason; none may crash or hang.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "scenes/gltf.h"
#include "scenes/gltf_export.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::scenes {
namespace {

using nlohmann::json;
using testing::drop;
using testing::Fault;
using testing::GltfFile;
using testing::load_gltf;
using testing::put;
using testing::put_accessor;
using testing::put_positions;

json light(const json& properties) {
  return {{"KHR_lights_punctual", {{"lights", json::array({properties})}}}};
}

void give_light(GltfFile& file, const json& properties) {
  file.json["extensions"] = light(properties);
  file.json["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
}

std::function<void(GltfFile&)> lit(const json& properties) {
  return [=](GltfFile& file) { give_light(file, properties); };
}

std::function<void(GltfFile&)> indices(const std::vector<std::uint16_t>& values) {
  return [=](GltfFile& file) { file.primitive()["indices"] = file.add_indices(values); };
}

std::function<void(GltfFile&)> with_material(const json& material) {
  return [=](GltfFile& file) {
    file.json["materials"] = json::array({material});
    file.primitive()["material"] = 0;
  };
}

void give_camera(GltfFile& file, double fov) {
  file.json["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", fov}, {"znear", 0.1}}}}});
  file.json["nodes"][0]["camera"] = 0;
}

void give_sparse(GltfFile& file, int count, const std::vector<std::uint8_t>& where) {
  const int indices = file.add_view(where);
  const int values = file.add_view<float>({0, 0, 0});
  file.json["accessors"][0]["sparse"] = {{"count", count},
                                         {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                         {"values", {{"bufferView", values}}}};
}

json deep(int levels) {
  json inner = 1;
  for (int i = 0; i < levels; ++i) {
    inner = json::array({inner});
  }
  return inner;
}

const std::vector<Fault>& faults() {
  static const std::vector<Fault> list = {
      {"index out of range", "index 4 is out of range",
       indices({0, 1, 4})},
      {"restart index", "65535",
       indices({0, 1, 65535})},
      {"indices not a multiple of three", "do not make triangles",
       indices({0, 1, 2, 3})},
      {"strip of two", "do not make triangles",
       [](GltfFile& f) {
         f.primitive()["mode"] = 5;
         f.primitive()["indices"] = f.add_indices({0, 1});
       }},
      {"no such primitive mode", "mode 7", put("/meshes/0/primitives/0/mode", 7)},
      {"signed indices", "unsigned scalars",
       put_accessor<std::int16_t>("/meshes/0/primitives/0/indices", {0, 1, 2}, 5122, "SCALAR", 1)},
      {"float indices", "unsigned scalars",
       put_accessor<float>("/meshes/0/primitives/0/indices", {0, 1, 2}, 5126, "SCALAR", 1)},
      {"vector indices", "unsigned scalars",
       put_accessor<std::uint16_t>("/meshes/0/primitives/0/indices", {0, 1, 2, 3}, 5123, "VEC2", 2)},
      {"missing indices accessor", "out of bounds", put("/meshes/0/primitives/0/indices", 99)},
      {"missing position accessor", "accessor 99",
       put("/meshes/0/primitives/0/attributes/POSITION", 99)},
      {"two-dimensional positions", "wrong type",
       put("/accessors/0/type", "VEC2")},
      {"matrix positions", "wrong type", put("/accessors/0/type", "MAT2")},
      {"double positions", "component type 5130",
       put("/accessors/0/componentType", 5130)},
      {"unknown component type", "componentType",
       put("/accessors/0/componentType", 7)},
      {"unknown accessor type", "type", put("/accessors/0/type", "VEC9")},
      {"accessor beyond its view", "do not fit", put("/accessors/0/count", 5)},
      {"accessor of nothing", "0 elements", put("/accessors/0/count", 0)},
      {"count that overflows", "elements",
       put("/accessors/0/count", 0x5555555555555556ULL)},
      {"index count that overflows", "elements",
       put("/accessors/1/count", 0x8000000000000001ULL)},
      {"offset that overflows", "do not fit",
       put("/accessors/0/byteOffset", 0xfffffffffffffff0ULL)},
      {"offset beyond the view", "do not fit",
       put("/accessors/0/byteOffset", 12)},
      {"negative count", "positive", put("/accessors/0/count", -4)},
      {"absurd count without a view", "no buffer view",
       [](GltfFile& f) {
         f.json["accessors"][0].erase("bufferView");
         f.json["accessors"][0]["count"] = 30'000'000;
       }},
      {"missing buffer view", "buffer view 77",
       put("/accessors/0/bufferView", 77)},
      {"view beyond its buffer", "too short",
       put("/bufferViews/0/byteLength", 1'000'000)},
      {"view that overflows", "too short",
       put("/bufferViews/0/byteOffset", 0xffffffffffffffffULL)},
      {"missing buffer", "buffer 5", put("/bufferViews/0/buffer", 5)},
      {"negative buffer", "buffer -1", put("/bufferViews/0/buffer", -1)},
      {"stride below the element", "stride of 4",
       put("/bufferViews/0/byteStride", 4)},
      {"odd stride", "byteStride", put("/bufferViews/0/byteStride", 13)},
      {"huge stride", "byteStride",
       put("/bufferViews/0/byteStride", 4'000'000'000U)},
      {"stride that runs out", "do not fit",
       put("/bufferViews/0/byteStride", 16)},
      {"buffer longer than the data", "byteLength",
       put("/buffers", json::array({{{"byteLength", 1'000'000}}}))},
      {"buffer of nothing", "",
       put("/buffers", json::array({{{"byteLength", 0}}}))},
      {"missing buffer file", "not-there.bin",
       put("/buffers", json::array({{{"byteLength", 4}, {"uri", "not-there.bin"}}}))},
      {"buffer from a device", "leads out of the scene's folder",
       put("/buffers", json::array({{{"byteLength", 4}, {"uri", "../../../../../../../dev/zero"}}}))},
      {"broken data URI", "uri",
       put("/buffers", json::array({{{"byteLength", 4}, {"uri", "data:application/octet-stream;base64,####"}}}))},
      {"sparse index out of range", "sparse index 9", [](GltfFile& f) { give_sparse(f, 1, {9}); }},
      {"more sparse values than elements", "sparse elements", [](GltfFile& f) { give_sparse(f, 50, {0}); }},
      {"negative sparse count", "sparse elements", [](GltfFile& f) { give_sparse(f, -1, {0}); }},
      {"sparse data too short", "do not fit",
       [](GltfFile& f) {
         give_sparse(f, 2, {0, 1});
       }},
      {"sparse without values", "values",
       [](GltfFile& f) {
         give_sparse(f, 1, {0});
         f.json["accessors"][0]["sparse"].erase("values");
       }},
      {"normals of another number", "normals",
       put_positions("/meshes/0/primitives/0/attributes/NORMAL", {0, 0, 1})},
      {"missing mesh", "mesh 3", put("/nodes/0/mesh", 3)},
      {"missing material", "material 2", put("/meshes/0/primitives/0/material", 2)},
      {"missing child", "node 8", put("/nodes/0/children", {8})},
      {"own child", "recursive",
       put("/nodes/-", {{"children", {1}}})},
      {"own child as root", "child of another",
       [](GltfFile& f) {
         f.json["nodes"] = json::array({{{"mesh", 0}, {"children", {1}}}, {{"mesh", 0}}});
         f.json["scenes"][0]["nodes"] = {0, 1};
       }},
      {"cycle of three", "recursive",
       [](GltfFile& f) {
         for (const int child : {2, 3, 1}) {
           f.json["nodes"].push_back({{"children", {child}}});
         }
       }},
      {"two parents", "child of two",
       [](GltfFile& f) {
         f.json["nodes"] = json::array({{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}});
         f.json["scenes"][0]["nodes"] = {0, 1};
       }},
      {"twice a child", "child of two",
       put("/nodes", json::array({{{"children", {1, 1}}}, {{"mesh", 0}}}))},
      {"twice a root", "twice",
       put("/scenes/0/nodes", {0, 0})},
      {"missing root", "node 12", put("/scenes/0/nodes", {12})},
      {"missing scene", "scene 6", put("/scene", 6)},
      {"short matrix", "16 finite",
       put("/nodes/0/matrix", {1, 2, 3})},
      {"projecting matrix", "last row",
       put("/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})},
      {"short rotation", "4 finite",
       put("/nodes/0/rotation", {0, 1})},
      {"zero rotation", "quaternion",
       put("/nodes/0/rotation", {0, 0, 0, 0})},
      {"transform that overflows", "not finite",
       put("/nodes", json::array( {{{"scale", {1e200, 1, 1}}, {"children", {1}}}, {{"scale", {1e200, 1, 1}}, {"mesh", 0}}}))},
      {"all positions too large", "finite positions",
       put("/nodes/0/translation", {1e200, 0, 0})},
      {"negative colour", "base colour",
       with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {-1, 0, 0, 1}}}}})},
      {"short colour", "baseColorFactor",
       with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {1}}}}})},
      {"index of refraction below one", "refraction",
       with_material({{"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}})},
      {"missing texture", "texture 4",
       with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 4}}}}}})},
      {"texture without an image", "image -1",
       [](GltfFile& f) {
         f.json["materials"] =
             json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
         f.json["textures"] = json::array({json::object()});
         f.primitive()["material"] = 0;
       }},
      {"image outside its buffer", "too short",
       [](GltfFile& f) {
         f.json["materials"] =
             json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
         f.json["textures"] = json::array({{{"source", 0}}});
         f.json["images"] = json::array({{{"bufferView", 2}, {"mimeType", "image/png"}}});
         f.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 1U << 30}, {"byteLength", 1U << 30}});
         f.primitive()["material"] = 0;
       }},
      {"negative light", "intensity",
       lit({{"type", "point"}, {"intensity", -1}})},
      {"infinite light", "intensity",
       lit({{"type", "point"}, {"intensity", 1e300}})},
      {"unknown light", "area",
       lit({{"type", "area"}})},
      {"light colour of two", "3 numbers",
       lit({{"type", "point"}, {"color", {1, 1}}})},
      {"inverted cone", "inner cone",
       lit({{"type", "spot"}, {"spot", {{"innerConeAngle", 1.0}, {"outerConeAngle", 0.5}}}})},
      {"missing light", "light 5",
       [](GltfFile& f) {
         give_light(f, {{"type", "point"}});
         f.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 5;
       }},
      {"absurd light index", "no light",
       [](GltfFile& f) {
         give_light(f, {{"type", "point"}});
         f.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 1e30;
       }},
      {"sun without a direction", "no direction",
       [](GltfFile& f) {
         give_light(f, {{"type", "directional"}});
         f.json["nodes"][0]["scale"] = {1, 1, 0};
       }},
      {"camera without an angle", "field of view", [](GltfFile& f) { give_camera(f, 0.0); }},
      {"camera of one point", "above 1e-6 and below pi - 1e-6", [](GltfFile& f) { give_camera(f, 1e-6); }},
      {"camera that sees behind", "field of view", [](GltfFile& f) { give_camera(f, 4.0); }},
      {"missing camera", "camera 3", put("/nodes/0/camera", 3)},
      {"an extension nobody knows", "requires the extension \"EXT_nobody_knows\", which is not supported",
       put("/extensionsRequired", {"EXT_nobody_knows"})},
      {"no triangles", "no triangles", put("/meshes/0/primitives/0/mode", 0)},
      {"no nodes", "no triangles", put("/scenes/0/nodes", json::array())},
      {"no version", "asset", drop("/asset")},
      {"version 9", "/asset/version is \"9.0\"", put("/asset/version", "9.0")},
      {"a later version is needed", "/asset/minVersion is \"2.1\"", put("/asset/minVersion", "2.1")},
      {"mesh beyond 32 bits", "/nodes/0/mesh is 4294967296, which is no whole number of at most 2147483647",
       put("/nodes/0/mesh", 4294967296)},
      {"scene beyond 32 bits", "/scene is 4294967296", put("/scene", 4294967296)},
      {"negative scene beyond 32 bits", "/scene is -4294967296", put("/scene", -4294967296)},
      {"accessor beyond 32 bits", "/meshes/0/primitives/0/attributes/POSITION is 4294967296",
       put("/meshes/0/primitives/0/attributes/POSITION", 4294967296)},
      {"node of a scene beyond 32 bits", "/scenes/0/nodes/0 is 4294967296", put("/scenes/0/nodes/0", 4294967296)},
      {"accessor of a morph target beyond 32 bits", "/meshes/0/primitives/0/targets/0/POSITION is 4294967296",
       put("/meshes/0/primitives/0/targets", {{{"POSITION", 4294967296}}})},
      {"compressed count beyond 32 bits", "/bufferViews/0/extensions/EXT_meshopt_compression/count is 4295967296",
       put("/bufferViews/0/extensions/EXT_meshopt_compression/count", 4295967296)},
      {"a mode between modes", "/meshes/0/primitives/0/mode is 4.5", put("/meshes/0/primitives/0/mode", 4.5)},
      {"a mode that is a text", "/meshes/0/primitives/0/mode is \"4\", which is no number",
       put("/meshes/0/primitives/0/mode", "4")},
      {"a translation with a text", "/nodes/0/translation/1 is \"a\", which is no number",
       put("/nodes/0/translation", {0, "a", 0})},
      {"a rotation that is a text", "/nodes/0/rotation is \"x\"", put("/nodes/0/rotation", "x")},
      {"a scale of null", "/nodes/0/scale/2 is null", put("/nodes/0/scale", {1, 1, nullptr})},
      {"an extension that is a list", "/nodes/0/extensions/X is a list; an extension is an object",
       put("/nodes/0/extensions/X", json::array())},
      {"an extension that is a number", "/nodes/0/extensions/X is 5; an extension is an object",
       put("/nodes/0/extensions/X", 5)},
      {"nested extras", "nested deeper", put("/extras", deep(200))},
      {"nested extension", "nested deeper",
       put("/nodes/0/extensions/X/y", deep(300))},
      {"meshes that are no objects", "object",
       put("/meshes", {1, 2})},
      {"primitive without attributes", "attributes", drop("/meshes/0/primitives/0/attributes")},
  };
  return list;
}

TEST(Hostile, EveryFaultIsRefusedWithPathAndReason) {
  const test::TemporaryDirectory directory;
  FileOptions strict;
  strict.strict = true;
  for (const Fault& fault : faults()) {
    SCOPED_TRACE(fault.name);
    GltfFile file = GltfFile::square();
    fault.damage(file);
    const auto path = file.write_glb(directory.path(), "hostile.glb");
    const std::string message = test::user_error_of([&] { static_cast<void>(load_gltf(path, strict, {})); });
    EXPECT_EQ(message.rfind(path.string() + ": ", 0), 0U) << message;
    EXPECT_NE(message.find(fault.reason), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(Hostile, FilesThatAreNoGltf) {
  const test::TemporaryDirectory directory;
  const auto message = [&](const std::string& name) {
    return test::user_error_of([&] { static_cast<void>(load_gltf(directory.path() / name, {}, {})); });
  };
  EXPECT_NE(message("absent.glb").find("absent.glb"), std::string::npos);
  std::filesystem::create_directory(directory.path() / "folder.glb");
  EXPECT_NE(message("folder.glb").find("folder.glb"), std::string::npos);
  const std::string good = GltfFile::square().glb();
  const std::vector<std::string> contents = {"",       "g",    "glTF",        "{}",
                                             "[]",     "null", "{\"asset\":", "\xff",
                                             "glTF\2", "{{{{", "not a",       std::string(100, '\0')};
  for (const std::string& content : contents) {
    testing::write_bytes(directory.path() / "x.gltf", content);
    EXPECT_EQ(message("x.gltf").rfind((directory.path() / "x.gltf").string(), 0), 0U) << message("x.gltf");
  }
  for (std::size_t length = 0; length < good.size(); length += 7) {
    testing::write_bytes(directory.path() / "cut.glb", good.substr(0, length));
    EXPECT_EQ(message("cut.glb").rfind((directory.path() / "cut.glb").string(), 0), 0U) << length;
  }
  testing::write_bytes(directory.path() / "deep.gltf", std::string(1'000'000, '['));
  EXPECT_NE(message("deep.gltf").find("nested deeper"), std::string::npos);
}

TEST(Hostile, LimitsHold) {
  const test::TemporaryDirectory directory;
  GltfFile file = GltfFile::square();
  file.json["nodes"] = json::array();
  file.json["scenes"][0]["nodes"] = json::array();
  for (int i = 0; i < 50; ++i) {
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"].push_back(i);
  }
  const auto path = file.write_glb(directory.path(), "many.glb");
  const auto message = [&](const FileOptions& options) {
    return test::user_error_of([&] { static_cast<void>(load_gltf(path, options, {})); });
  };
  EXPECT_EQ(load_gltf(path, {}, {}).triangles.size(), 100U);
  FileOptions options;
  options.max_triangles = 200;
  EXPECT_EQ(message(options), "no UserError") << "100 triangles and 200 vertices are just accepted";
  options.max_triangles = 199;
  EXPECT_NE(message(options).find("more than 199"), std::string::npos);
  options = {};
  options.max_file_bytes = 100;
  EXPECT_NE(message(options).find("many.glb"), std::string::npos);
  options = {};
  options.time = 1;
  EXPECT_NE(message(options).find("no animation plays"), std::string::npos);
  options = {};
  options.animation = "walk";
  EXPECT_NE(message(options).find("no animation"), std::string::npos);
}

TEST(Hostile, ManyInstancesOfManyPointsEnd) {
  const test::TemporaryDirectory directory;
  GltfFile file = GltfFile::square();
  const json points = {{"attributes", {{"POSITION", 0}}}, {"mode", 0}};
  file.json["meshes"][0]["primitives"] = std::vector<json>(2'000, points);
  file.json["nodes"] = std::vector<json>(2'000, {{"mesh", 0}});
  file.json["scenes"] = json::array();
  const auto path = file.write_glb(directory.path(), "points.glb");
  FileOptions options;
  options.max_triangles = 1U << 20U;
  const std::string message = test::user_error_of([&] { static_cast<void>(load_gltf(path, options, {})); });
  EXPECT_NE(message.find("more than 1048576 primitives"), std::string::npos) << message;
}

TEST(Hostile, WhatOthersKeepInExtrasAndExtensionsIsTheirs) {
  const test::TemporaryDirectory directory;
  GltfFile file = GltfFile::square();
  const json own = {
      {"mesh", 4294967296}, {"scale", "large"}, {"mode", nullptr}, {"extensions", {{"list", {1.5}}}}};
  file.json["extras"] = own;
  file.json["nodes"][0]["extensions"]["EXT_nobody_knows"] = {{"mesh", 4294967296}, {"scale", true}};
  EXPECT_EQ(load_gltf(file.write_glb(directory.path(), "own.glb"), {}, {}).triangles.size(), 2U);
}

TEST(Hostile, DeepHierarchiesNeedNoStack) {
  const test::TemporaryDirectory directory;
  GltfFile file = GltfFile::square();
  constexpr int depth = 100'000;
  file.json["nodes"] = json::array();
  for (int i = 0; i < depth; ++i) {
    file.json["nodes"].push_back({{"children", {i + 1}}});
  }
  file.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(load_gltf(file.write_glb(directory.path(), "deep.glb"), {}, {}).triangles.size(), 2U);
}

TEST(Hostile, FlippedBytesEitherLoadOrAreRefused) {
  const test::TemporaryDirectory directory;
  export_glb(make_procedural("teapot:2"), directory.path() / "good.glb");
  const std::string good = testing::read_bytes(directory.path() / "good.glb");
  const auto path = directory.path() / "flipped.glb";
  EXPECT_TRUE(rc::check("no flip of bytes crashes the loader", [&] {
    std::string bytes = good;
    const int flips = *rc::gen::inRange(1, 6);
    // Half of the flips hit the JSON, whose length is the fourth word.
    std::uint32_t json_length = 0;
    std::memcpy(&json_length, good.data() + 12, 4);
    for (int i = 0; i < flips; ++i) {
      const auto limit =
          *rc::gen::arbitrary<bool>() ? 20 + json_length : static_cast<std::uint32_t>(good.size());
      const auto at = *rc::gen::inRange<std::uint32_t>(0, limit);
      bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ *rc::gen::inRange(1, 256));
    }
    testing::write_bytes(path, bytes);
    try {
      const Scene scene = load_gltf(path, {}, {});
      for (const Triangle& triangle : scene.triangles) {
        for (const std::uint32_t vertex : triangle.vertex) {
          RC_ASSERT(vertex < scene.positions.size());
        }
        RC_ASSERT(triangle.material < scene.materials.size());
      }
      for (const glm::dvec3& p : scene.positions) {
        RC_ASSERT(std::abs(p.x) <= 1e30 && std::abs(p.y) <= 1e30 && std::abs(p.z) <= 1e30);
      }
    } catch (const sim::UserError& error) {
      RC_ASSERT(std::string(error.what()).rfind(path.string() + ": ", 0) == 0U);
    }
  }));
}

TEST(Hostile, ChangedNumbersEitherLoadOrAreRefused) {
  // Whole numbers of the JSON replaced by odd ones: reaches deeper than flipped bytes.
  const test::TemporaryDirectory directory;
  GltfFile file = GltfFile::square();
  give_sparse(file, 1, {1});
  give_camera(file, 1.0);
  file.json["materials"] = json::array({{{"extensions", {{"KHR_materials_ior", {{"ior", 1.5}}}}}}});
  file.primitive()["material"] = 0;
  const json flat = file.json.flatten();
  std::vector<std::string> numbers;
  for (const auto& [key, value] : flat.items()) {
    if (value.is_number()) {
      numbers.push_back(key);
    }
  }
  const std::vector<json> odd = {
      -1,          0,    1,     2,     3,    5,      255,  65536, 2147483647,           2147483648U,
      4294967295U, 1e18, -1e18, 1e308, -0.0, 1e-320, 5126, 5121,  0xffffffffffffffffULL};
  for (const std::string& key : numbers) {
    for (const json& value : odd) {
      GltfFile changed = file;
      changed.json[json::json_pointer(key)] = value;
      const auto path = changed.write_glb(directory.path(), "odd.glb");
      try {
        const Scene scene = load_gltf(path, {}, {});
        EXPECT_FALSE(scene.triangles.empty());
      } catch (const sim::UserError& error) {
        EXPECT_EQ(std::string(error.what()).rfind(path.string() + ": ", 0), 0U) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace marti::scenes
