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
using testing::gl_float;
using testing::GltfFile;
using testing::skinned_square;

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float without_end = std::numeric_limits<float>::infinity();

struct Fault {
  const char* name;
  const char* reason;  ///< must occur in the message
  std::function<void(GltfFile&)> damage;
};

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

void set_times(GltfFile& file, const std::vector<float>& times) {
  sampler(file, 0)["input"] = file.add_accessor(times, gl_float, "SCALAR", 1);
}

json& attributes(GltfFile& file) { return file.primitive()["attributes"]; }

const std::vector<Fault>& faults() {
  static const std::vector<Fault> list = {
      {"missing sampler", "sampler 9", [](GltfFile& f) { channel(f, 0)["sampler"] = 9; }},
      {"negative sampler", "sampler -1", [](GltfFile& f) { channel(f, 0)["sampler"] = -1; }},
      {"channel without a sampler", "sampler", [](GltfFile& f) { channel(f, 0).erase("sampler"); }},
      {"missing target node", "node 77", [](GltfFile& f) { channel(f, 1)["target"]["node"] = 77; }},
      {"negative target node", "node -1", [](GltfFile& f) { channel(f, 1)["target"]["node"] = -1; }},
      {"target that is no node", "node", [](GltfFile& f) { channel(f, 1)["target"]["node"] = "second"; }},
      {"unknown path", "changes 'colour'", [](GltfFile& f) { channel(f, 1)["target"]["path"] = "colour"; }},
      {"no path", "path", [](GltfFile& f) { channel(f, 1)["target"].erase("path"); }},
      {"target twice", "another channel changes already",
       [](GltfFile& f) { f.json["animations"][0]["channels"].push_back(channel(f, 1)); }},
      {"weights without a mesh", "no mesh with morph targets",
       [](GltfFile& f) { channel(f, 0)["target"]["node"] = 1; }},
      {"weights without targets", "no mesh with morph targets",
       [](GltfFile& f) { f.primitive().erase("targets"); }},
      {"matrix that is to be animated", "has a matrix",
       [](GltfFile& f) { f.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
      {"missing input", "accessor 99", [](GltfFile& f) { sampler(f, 0)["input"] = 99; }},
      {"missing output", "accessor 99", [](GltfFile& f) { sampler(f, 0)["output"] = 99; }},
      {"no input", "input", [](GltfFile& f) { sampler(f, 0).erase("input"); }},
      {"unknown interpolation", "'SMOOTH'", [](GltfFile& f) { sampler(f, 0)["interpolation"] = "SMOOTH"; }},
      {"times of integers", "must be floats",
       [](GltfFile& f) {
         sampler(f, 0)["input"] = f.add_accessor<std::uint16_t>({0, 1}, 5123, "SCALAR", 1);
       }},
      {"times of vectors", "wrong type",
       [](GltfFile& f) {
         sampler(f, 0)["input"] = f.add_positions({0, 0, 0, 1, 1, 1});
       }},
      {"times that fall", "must increase",
       [](GltfFile& f) {
         set_times(f, {1, 0});
       }},
      {"times that stand", "must increase",
       [](GltfFile& f) {
         set_times(f, {0.5F, 0.5F});
       }},
      {"time below 0", "below 0",
       [](GltfFile& f) {
         set_times(f, {-1, 0});
       }},
      {"time that is no number", "not finite",
       [](GltfFile& f) {
         set_times(f, {0, not_a_number});
       }},
      {"time without end", "not finite",
       [](GltfFile& f) {
         set_times(f, {0, without_end});
       }},
      {"too few values", "are needed for 3 key frames",
       [](GltfFile& f) {
         set_times(f, {0, 1, 2});
       }},
      {"too many values", "are needed for 1 key frames", [](GltfFile& f) { set_times(f, {0}); }},
      {"spline of one key frame", "two key frames",
       [](GltfFile& f) {
         sampler(f, 3)["input"] = f.add_accessor<float>({0}, gl_float, "SCALAR", 1);
         sampler(f, 3)["output"] = f.add_positions({1, 1, 1, 1, 1, 1, 1, 1, 1});
       }},
      {"spline without tangents", "are needed",
       [](GltfFile& f) {
         sampler(f, 3)["output"] = f.add_positions({1, 1, 1, 1, 1, 1});
       }},
      {"rotation of three", "wrong type",
       [](GltfFile& f) {
         sampler(f, 1)["output"] = f.add_positions({0, 0, 0, 1, 1, 1});
       }},
      {"rotation of no length", "no unit quaternion",
       [](GltfFile& f) {
         sampler(f, 1)["output"] = f.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 0}, gl_float, "VEC4", 4);
       }},
      {"rotation of plain integers", "normalised integers",
       [](GltfFile& f) {
         sampler(f, 1)["output"] = f.add_accessor<std::int8_t>({0, 0, 0, 1, 0, 0, 0, 1}, 5120, "VEC4", 4);
       }},
      {"translation of integers", "must be floats",
       [](GltfFile& f) {
         sampler(f, 2)["output"] = f.add_accessor<std::int8_t>({0, 0, 0, 1, 1, 1}, 5120, "VEC3", 3);
       }},
      {"value that is no number", "not finite",
       [](GltfFile& f) {
         sampler(f, 2)["output"] = f.add_positions({0, 0, 0, not_a_number, 0, 0});
       }},
      {"tangent that is no number", "not finite",
       [](GltfFile& f) {
         std::vector<float> values(18, 1.0F);
         values[17] = without_end;
         sampler(f, 3)["output"] = f.add_positions(values);
       }},
      {"weights of the wrong number", "must be 2 finite numbers",
       [](GltfFile& f) { f.json["nodes"][0]["weights"] = {1}; }},
      {"mesh weights of the wrong number", "must be 2 finite numbers",
       [](GltfFile& f) {
         f.json["meshes"][0]["weights"] = {1, 2, 3};
       }},
      {"primitives that do not agree", "same number of morph targets",
       [](GltfFile& f) {
         json other = f.primitive();
         other.erase("targets");
         f.json["meshes"][0]["primitives"].push_back(other);
       }},
      {"displacements of the wrong number", "4 positions, but 1 displacements",
       [](GltfFile& f) {
         f.primitive()["targets"][1]["POSITION"] = f.add_positions({0, 0, 0});
       }},
      {"missing displacements", "accessor 99",
       [](GltfFile& f) { f.primitive()["targets"][1]["POSITION"] = 99; }},
      {"displacements in two dimensions", "wrong type",
       [](GltfFile& f) {
         f.primitive()["targets"][0]["POSITION"] =
             f.add_accessor<float>({0, 0, 0, 0, 0, 0, 0, 0}, gl_float, "VEC2", 2);
       }},
      {"missing skin", "skin 4", [](GltfFile& f) { f.json["nodes"][0]["skin"] = 4; }},
      {"skin without joints", "no joints", [](GltfFile& f) { f.json["skins"][0]["joints"] = json::array(); }},
      {"missing joint", "node 55",
       [](GltfFile& f) {
         f.json["skins"][0]["joints"] = {1, 55};
       }},
      {"joint outside the scene", "not in the scene",
       [](GltfFile& f) {
         f.json["nodes"].push_back(json::object());
         f.json["skins"][0]["joints"] = {1, 3};
       }},
      {"too few inverse bind matrices", "3 are needed",
       [](GltfFile& f) {
         f.json["skins"][0]["joints"] = {1, 2, 0};
       }},
      {"missing inverse bind matrices", "accessor 99",
       [](GltfFile& f) { f.json["skins"][0]["inverseBindMatrices"] = 99; }},
      {"inverse bind vectors", "4 x 4 matrices",
       [](GltfFile& f) { f.json["skins"][0]["inverseBindMatrices"] = 0; }},
      {"inverse bind matrices that project", "last row",
       [](GltfFile& f) {
         f.json["skins"][0]["inverseBindMatrices"] =
             f.add_accessor(std::vector<float>(32, 1.0F), gl_float, "MAT4", 16);
       }},
      {"inverse bind matrices without an end", "must be finite",
       [](GltfFile& f) {
         std::vector<float> m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, not_a_number, 0, 0, 1};
         m.insert(m.end(), m.begin(), m.end());
         f.json["skins"][0]["inverseBindMatrices"] = f.add_accessor(m, gl_float, "MAT4", 16);
       }},
      {"skinned mesh without joints", "JOINTS_n", [](GltfFile& f) { attributes(f).erase("JOINTS_0"); }},
      {"skinned mesh without weights", "WEIGHTS_n", [](GltfFile& f) { attributes(f).erase("WEIGHTS_0"); }},
      {"sets with a gap", "JOINTS_1",
       [](GltfFile& f) {
         attributes(f)["JOINTS_2"] = attributes(f)["JOINTS_0"];
         attributes(f)["WEIGHTS_2"] = attributes(f)["WEIGHTS_0"];
       }},
      {"joint out of range", "joint 2 is out of range",
       [](GltfFile& f) {
         attributes(f)["JOINTS_0"] = f.add_accessor(std::vector<std::uint8_t>(16, 2), 5121, "VEC4", 4);
       }},
      {"joints of floats", "must be unsigned",
       [](GltfFile& f) {
         attributes(f)["JOINTS_0"] = f.add_accessor(std::vector<float>(16, 0), gl_float, "VEC4", 4);
       }},
      {"joints of the wrong number", "4 positions, but 1",
       [](GltfFile& f) {
         attributes(f)["JOINTS_0"] = f.add_accessor(std::vector<std::uint8_t>(4, 0), 5121, "VEC4", 4);
       }},
      {"joints of three", "wrong type",
       [](GltfFile& f) {
         attributes(f)["JOINTS_0"] = f.add_accessor(std::vector<std::uint8_t>(12, 0), 5121, "VEC3", 3);
       }},
      {"weights of plain integers", "must be floats, or normalised",
       [](GltfFile& f) {
         attributes(f)["WEIGHTS_0"] = f.add_accessor(std::vector<std::uint8_t>(16, 1), 5121, "VEC4", 4);
       }},
      {"negative weight", "negative or not finite",
       [](GltfFile& f) {
         attributes(f)["WEIGHTS_0"] = f.add_accessor(std::vector<float>(16, -1), gl_float, "VEC4", 4);
       }},
      {"weight that is no number", "negative or not finite",
       [](GltfFile& f) {
         attributes(f)["WEIGHTS_0"] =
             f.add_accessor(std::vector<float>(16, not_a_number), gl_float, "VEC4", 4);
       }},
      {"vertex that no joint moves", "add up to 0",
       [](GltfFile& f) {
         attributes(f)["WEIGHTS_0"] = f.add_accessor(std::vector<float>(16, 0), gl_float, "VEC4", 4);
       }},
      {"animations that are no objects", "animations",
       [](GltfFile& f) {
         f.json["animations"] = {1, 2};
       }},
      {"skins that are no objects", "skins",
       [](GltfFile& f) {
         f.json["skins"] = {1, 2};
       }},
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
  for (const Fault& fault : faults()) {
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
  GltfOptions options;
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
  GltfOptions options;
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
  GltfOptions options;
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
  rc::check("no flip of bytes crashes the loader", [&] {
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
  });
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
