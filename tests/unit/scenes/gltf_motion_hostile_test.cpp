// Broken and malicious animations, morph targets and skins: refused with path and reason, never a crash.
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "animated_file.h"
#include "scenes/animated.h"
#include "scenes/gltf.h"
#include "sim/error.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::scenes {
namespace {

using nlohmann::json;
using testing::animate;
using testing::drop;
using testing::Fault;
using testing::gl_float;
using testing::GltfFile;
using testing::put;
using testing::put_accessor;
using testing::put_positions;
using testing::skinned_square;

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float without_end = std::numeric_limits<float>::infinity();

/// A square that swings, morphs and hangs on joints, all of which move.
GltfFile everything() {
  GltfFile file = skinned_square();
  file.primitive()["targets"] = {{{"POSITION", file.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})}},
                                 {{"POSITION", file.add_positions({1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1})}}};
  animate(file, 0, "weights", {0, 1}, {0, 0, 1, 1});
  animate(file, 1, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  animate(file, 2, "translation", {0, 1}, {0, 1, 0, 0, 2, 0}, "STEP");
  animate(file, 2, "scale", {0, 1}, std::vector<float>(18, 1.0F), "CUBICSPLINE");
  return file;
}

json& channel(GltfFile& file, std::size_t i) { return file.json["animations"][0]["channels"][i]; }
json& sampler(GltfFile& file, std::size_t i) { return file.json["animations"][0]["samplers"][i]; }

std::function<void(GltfFile&)> times(const std::vector<float>& values) {
  return put_accessor("/animations/0/samplers/0/input", values, gl_float, "SCALAR", 1);
}

json& attributes(GltfFile& file) { return file.primitive()["attributes"]; }

const std::vector<Fault>& motion_faults() {
  static const std::vector<Fault> list = {
      {"missing sampler", "sampler 9", put("/animations/0/channels/0/sampler", 9)},
      {"negative sampler", "sampler -1", put("/animations/0/channels/0/sampler", -1)},
      {"channel without a sampler", "sampler", drop("/animations/0/channels/0/sampler")},
      {"missing target node", "node 77", put("/animations/0/channels/1/target/node", 77)},
      {"negative target node", "node -1", put("/animations/0/channels/1/target/node", -1)},
      {"target that is no node", "node", put("/animations/0/channels/1/target/node", "second")},
      {"unknown path", "changes 'colour'", put("/animations/0/channels/1/target/path", "colour")},
      {"no path", "path", drop("/animations/0/channels/1/target/path")},
      {"target twice", "another channel changes already",
       [](GltfFile& f) { f.json["animations"][0]["channels"].push_back(channel(f, 1)); }},
      {"weights without a mesh", "no mesh with morph targets",
       put("/animations/0/channels/0/target/node", 1)},
      {"weights without targets", "no mesh with morph targets", drop("/meshes/0/primitives/0/targets")},
      {"matrix that is to be animated", "has a matrix",
       put("/nodes/1/matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})},
      {"missing input", "accessor 99", put("/animations/0/samplers/0/input", 99)},
      {"missing output", "accessor 99", put("/animations/0/samplers/0/output", 99)},
      {"no input", "input", drop("/animations/0/samplers/0/input")},
      {"unknown interpolation", "'SMOOTH'", put("/animations/0/samplers/0/interpolation", "SMOOTH")},
      {"times of integers", "must be floats",
       put_accessor<std::uint16_t>("/animations/0/samplers/0/input", {0, 1}, 5123, "SCALAR", 1)},
      {"times of vectors", "wrong type",
       put_positions("/animations/0/samplers/0/input", {0, 0, 0, 1, 1, 1})},
      {"times that fall", "must increase",
       times({1, 0})},
      {"times that stand", "must increase",
       times({0.5F, 0.5F})},
      {"time below 0", "below 0",
       times({-1, 0})},
      {"time that is no number", "not finite",
       times({0, not_a_number})},
      {"time without end", "not finite",
       times({0, without_end})},
      {"too few values", "are needed for 3 key frames",
       times({0, 1, 2})},
      {"too many values", "are needed for 1 key frames", times({0})},
      {"spline of one key frame", "two key frames",
       [](GltfFile& f) {
         sampler(f, 3)["input"] = f.add_accessor<float>({0}, gl_float, "SCALAR", 1);
         sampler(f, 3)["output"] = f.add_positions({1, 1, 1, 1, 1, 1, 1, 1, 1});
       }},
      {"spline without tangents", "are needed",
       put_positions("/animations/0/samplers/3/output", {1, 1, 1, 1, 1, 1})},
      {"rotation of three", "wrong type",
       put_positions("/animations/0/samplers/1/output", {0, 0, 0, 1, 1, 1})},
      {"rotation of no length", "no unit quaternion",
       put_accessor<float>("/animations/0/samplers/1/output", {0, 0, 0, 1, 0, 0, 0, 0}, gl_float, "VEC4", 4)},
      {"rotation of plain integers", "normalised integers",
       put_accessor<std::int8_t>("/animations/0/samplers/1/output", {0, 0, 0, 1, 0, 0, 0, 1}, 5120, "VEC4", 4)},
      {"translation of integers", "must be floats",
       put_accessor<std::int8_t>("/animations/0/samplers/2/output", {0, 0, 0, 1, 1, 1}, 5120, "VEC3", 3)},
      {"value that is no number", "not finite",
       put_positions("/animations/0/samplers/2/output", {0, 0, 0, not_a_number, 0, 0})},
      {"tangent that is no number", "not finite",
       [](GltfFile& f) {
         std::vector<float> values(18, 1.0F);
         values[17] = without_end;
         sampler(f, 3)["output"] = f.add_positions(values);
       }},
      {"weights of the wrong number", "must be 2 finite numbers", put("/nodes/0/weights", {1})},
      {"mesh weights of the wrong number", "must be 2 finite numbers", put("/meshes/0/weights", {1, 2, 3})},
      {"primitives that do not agree", "same number of morph targets",
       [](GltfFile& f) {
         json other = f.primitive();
         other.erase("targets");
         f.json["meshes"][0]["primitives"].push_back(other);
       }},
      {"displacements of the wrong number", "4 positions, but 1 displacements",
       put_positions("/meshes/0/primitives/0/targets/1/POSITION", {0, 0, 0})},
      {"missing displacements", "accessor 99", put("/meshes/0/primitives/0/targets/1/POSITION", 99)},
      {"displacements in two dimensions", "wrong type",
       put_accessor<float>("/meshes/0/primitives/0/targets/0/POSITION", {0, 0, 0, 0, 0, 0, 0, 0}, gl_float, "VEC2", 2)},
      {"missing skin", "skin 4", put("/nodes/0/skin", 4)},
      {"skin without joints", "no joints", put("/skins/0/joints", json::array())},
      {"missing joint", "node 55", put("/skins/0/joints", {1, 55})},
      {"joint outside the scene", "not in the scene",
       [](GltfFile& f) {
         f.json["nodes"].push_back(json::object());
         f.json["skins"][0]["joints"] = {1, 3};
       }},
      {"too few inverse bind matrices", "3 are needed", put("/skins/0/joints", {1, 2, 0})},
      {"missing inverse bind matrices", "accessor 99", put("/skins/0/inverseBindMatrices", 99)},
      {"inverse bind vectors", "4 x 4 matrices", put("/skins/0/inverseBindMatrices", 0)},
      {"inverse bind matrices that project", "last row",
       put_accessor("/skins/0/inverseBindMatrices", std::vector<float>(32, 1.0F), gl_float, "MAT4", 16)},
      {"inverse bind matrices without an end", "must be finite",
       [](GltfFile& f) {
         std::vector<float> m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, not_a_number, 0, 0, 1};
         m.insert(m.end(), m.begin(), m.end());
         f.json["skins"][0]["inverseBindMatrices"] = f.add_accessor(m, gl_float, "MAT4", 16);
       }},
      {"skinned mesh without joints", "JOINTS_n", drop("/meshes/0/primitives/0/attributes/JOINTS_0")},
      {"skinned mesh without weights", "WEIGHTS_n", drop("/meshes/0/primitives/0/attributes/WEIGHTS_0")},
      {"sets with a gap", "JOINTS_1",
       [](GltfFile& f) {
         attributes(f)["JOINTS_2"] = attributes(f)["JOINTS_0"];
         attributes(f)["WEIGHTS_2"] = attributes(f)["WEIGHTS_0"];
       }},
      {"joint out of range", "joint 2 is out of range",
       put_accessor("/meshes/0/primitives/0/attributes/JOINTS_0", std::vector<std::uint8_t>(16, 2), 5121, "VEC4", 4)},
      {"joints of floats", "must be unsigned",
       put_accessor("/meshes/0/primitives/0/attributes/JOINTS_0", std::vector<float>(16, 0), gl_float, "VEC4", 4)},
      {"joints of the wrong number", "4 positions, but 1",
       put_accessor("/meshes/0/primitives/0/attributes/JOINTS_0", std::vector<std::uint8_t>(4, 0), 5121, "VEC4", 4)},
      {"joints of three", "wrong type",
       put_accessor("/meshes/0/primitives/0/attributes/JOINTS_0", std::vector<std::uint8_t>(12, 0), 5121, "VEC3", 3)},
      {"weights of plain integers", "must be floats, or normalised",
       put_accessor("/meshes/0/primitives/0/attributes/WEIGHTS_0", std::vector<std::uint8_t>(16, 1), 5121, "VEC4", 4)},
      {"negative weight", "negative or not finite",
       put_accessor("/meshes/0/primitives/0/attributes/WEIGHTS_0", std::vector<float>(16, -1), gl_float, "VEC4", 4)},
      {"weight that is no number", "negative or not finite",
       put_accessor("/meshes/0/primitives/0/attributes/WEIGHTS_0", std::vector<float>(16, not_a_number), gl_float, "VEC4", 4)},
      {"vertex that no joint moves", "add up to 0",
       put_accessor("/meshes/0/primitives/0/attributes/WEIGHTS_0", std::vector<float>(16, 0), gl_float, "VEC4", 4)},
      {"animations that are no objects", "animations", put("/animations", {1, 2})},
      {"skins that are no objects", "skins", put("/skins", {1, 2})},
  };
  return list;
}

TEST(HostileMotion, TheUndamagedFileLoads) {
  const test::TemporaryDirectory directory;
  const AnimatedScene scene = open_gltf(everything().write_glb(directory.path(), "good.glb"), {}, {});
  EXPECT_EQ(scene.at(0.5).triangles.size(), 2U);
  EXPECT_EQ(moved_primitives(scene.at(0.0), scene.at(0.5)).size(), 2U);
}

TEST(HostileMotion, EveryFaultIsRefusedWithPathAndReason) {
  const test::TemporaryDirectory directory;
  for (const Fault& fault : motion_faults()) {
    SCOPED_TRACE(fault.name);
    GltfFile file = everything();
    fault.damage(file);
    const auto path = file.write_glb(directory.path(), "hostile.glb");
    const std::string message =
        test::user_error_of([&] { static_cast<void>(open_gltf(path, {}, {}).at(0.5)); });
    EXPECT_EQ(message.rfind(path.string() + ": ", 0), 0U) << message;
    EXPECT_NE(message.find(fault.reason), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(HostileMotion, LimitsHold) {
  const test::TemporaryDirectory directory;
  FileOptions options;
  options.max_triangles = 44;
  const auto message = [&](const GltfFile& file) {
    const auto path = file.write_glb(directory.path(), "many.glb");
    return test::user_error_of([&] { static_cast<void>(open_gltf(path, options, {}).at(0.5)); });
  };
  EXPECT_EQ(message(everything()), "no UserError");
  GltfFile file = everything();
  animate(file, 0, "translation", std::vector<float>{0, 1}, std::vector<float>(6, 0.0F));
  EXPECT_EQ(message(file), "no UserError");
  animate(file, 0, "rotation", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, std::vector<float>(40, 1.0F));
  EXPECT_NE(message(file).find("more than 44 key frames"), std::string::npos) << message(file);
  // Eleven instances of 4 vertices with 2 targets and 4 joints are more than 4 x 44 displacements and joints.
  file = everything();
  for (int i = 0; i < 10; ++i) {
    file.json["nodes"].push_back(file.json["nodes"][0]);
    file.json["scenes"][0]["nodes"].push_back(3 + i);
  }
  EXPECT_NE(message(file).find("more than 176 displacements"), std::string::npos) << message(file);
}

TEST(HostileMotion, ManyAnimationsOfOneLargeAccessorAreNotDescribedWithoutEnd) {
  const test::TemporaryDirectory directory;
  GltfFile file = everything();
  FileOptions options;
  options.max_triangles = 200;
  for (int i = 0; i < 20; ++i) {
    file.json["animations"].push_back(file.json["animations"][0]);
  }
  const AnimatedScene scene = open_gltf(file.write_glb(directory.path(), "list.glb"), options, {});
  EXPECT_EQ(scene.at(0.5).triangles.size(), 2U);
  const std::string message = test::user_error_of([&] { static_cast<void>(scene.facts()); });
  EXPECT_NE(message.find("more than is described"), std::string::npos) << message;
}

TEST(HostileMotion, OneSamplerOfManyWeightsIsNotCopiedWithoutEnd) {
  const test::TemporaryDirectory directory;
  GltfFile file = everything();
  FileOptions options;
  options.max_triangles = 44;
  json& channels = file.json["animations"][0]["channels"];
  for (int i = 0; i < 20; ++i) {
    file.json["nodes"].push_back({{"mesh", 0}});  // in no scene
    json channel = channels[0];
    channel["target"]["node"] = 3 + i;
    channels.push_back(channel);
  }
  const auto path = file.write_glb(directory.path(), "weights.glb");
  const std::string message = test::user_error_of([&] { static_cast<void>(open_gltf(path, options, {})); });
  EXPECT_NE(message.find("changes more than 44 numbers"), std::string::npos) << message;
}

TEST(HostileMotion, ManyTargetsOfManyInstancesEnd) {
  const test::TemporaryDirectory directory;
  GltfFile file = GltfFile::square();
  file.primitive()["targets"] = std::vector<json>(20'000, json::object());
  file.json["nodes"] = std::vector<json>(20'000, {{"mesh", 0}});
  file.json["scenes"] = json::array();
  const auto path = file.write_glb(directory.path(), "targets.glb");
  const std::string message = test::user_error_of([&] { static_cast<void>(open_gltf(path, {}, {})); });
  EXPECT_NE(message.find("displacements"), std::string::npos) << message;
}

/// A pose must be a valid scene with the ids of the first; returns whether the file could be posed.
bool pose_or_refuse(const std::filesystem::path& path) {
  try {
    const AnimatedScene scene = open_gltf(path, {}, {});
    const Scene first = scene.at(0.0);
    for (const double time : {0.3, 0.5, 1.0, 1e30}) {
      const Scene pose = scene.at(time);
      if (pose.triangles.size() != first.triangles.size()) {
        throw std::logic_error("ids change");
      }
      for (const Triangle& triangle : pose.triangles) {
        for (const std::uint32_t vertex : triangle.vertex) {
          const glm::dvec3& p = pose.positions.at(vertex);
          if (!(std::abs(p.x) <= 1e30 && std::abs(p.y) <= 1e30 && std::abs(p.z) <= 1e30)) {
            throw std::logic_error("a position is not finite");
          }
        }
      }
    }
    return true;
  } catch (const sim::UserError& error) {
    if (std::string(error.what()).rfind(path.string() + ": ", 0) != 0U) {
      throw std::logic_error("a message without a path");
    }
    return false;
  }
}

TEST(HostileMotion, FlippedBytesEitherPoseOrAreRefused) {
  const test::TemporaryDirectory directory;
  const std::string good = everything().glb();
  const auto path = directory.path() / "flipped.glb";
  int posed = 0;
  EXPECT_TRUE(rc::check("no flip of bytes crashes the loader", [&] {
    std::string bytes = good;
    std::uint32_t json_length = 0;
    std::memcpy(&json_length, good.data() + 12, 4);
    const int flips = *rc::gen::inRange(1, 6);
    for (int i = 0; i < flips; ++i) {
      const bool in_json = *rc::gen::inRange(0, 3) == 0;
      const auto at = *rc::gen::inRange<std::uint32_t>(
          in_json ? 20 : 20 + json_length,
          in_json ? 20 + json_length : static_cast<std::uint32_t>(good.size()));
      bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ *rc::gen::inRange(1, 256));
    }
    testing::write_bytes(path, bytes);
    posed += pose_or_refuse(path) ? 1 : 0;
  }));
  EXPECT_GT(posed, 0);
}

TEST(HostileMotion, ChangedNumbersEitherPoseOrAreRefused) {
  const test::TemporaryDirectory directory;
  const GltfFile good = everything();
  const json flat = good.json.flatten();
  const std::vector<json> odd = {-1, 0, 3, 7, 2147483647, 1e308, 5121};
  int posed = 0;
  for (const auto& [key, value] : flat.items()) {
    if (value.is_number()) {
      for (const json& number : odd) {
        GltfFile changed = good;
        changed.json[json::json_pointer(key)] = number;
        SCOPED_TRACE(key + " = " + number.dump());
        ASSERT_NO_THROW(posed += pose_or_refuse(changed.write_glb(directory.path(), "odd.glb")) ? 1 : 0);
      }
    }
  }
  EXPECT_GT(posed, 0);
}

}  // namespace
}  // namespace marti::scenes
