// Scenes over time: node animations, lights and cameras on moving nodes, and what stays the same in every
// pose.
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "animated_file.h"
#include "scenes/animated.h"
#include "scenes/gltf.h"
#include "scenes/open.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/scenes/loaded_scene.h"

namespace marti::scenes {
namespace {

using nlohmann::json;
using testing::animate;
using testing::corner;
using testing::GltfFile;
using testing::has_note;

class GltfAnimation : public ::testing::Test {
 protected:
  AnimatedScene open(const GltfFile& file, const FileOptions& options = {}) {
    return open_gltf(file.write_glb(directory_.path(), "scene.glb"), options, {});
  }
  std::string refusal(const GltfFile& file, const FileOptions& options = {}, double time = 0.0) {
    return test::user_error_of([&] { static_cast<void>(open(file, options).at(time)); });
  }
  test::TemporaryDirectory directory_;
};

bool same_bits(const glm::dvec3& a, const glm::dvec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST_F(GltfAnimation, AQuarterTurnAtHalfTimeIsFortyFiveDegrees) {
  GltfFile file = GltfFile::square();
  const auto h = static_cast<float>(std::sqrt(0.5));
  animate(file, 0, "rotation", {1, 3}, {0, 0, 0, 1, 0, 0, h, h});
  const AnimatedScene scene = open(file);
  EXPECT_TRUE(scene.moves());
  EXPECT_EQ(scene.duration(), 3.0);
  for (const auto& [time, degrees] : std::vector<std::pair<double, double>>{
           {0.0, 0.0}, {1.0, 0.0}, {1.5, 22.5}, {2.0, 45.0}, {2.5, 67.5}, {3.0, 90.0}, {9.0, 90.0}}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const glm::dvec3 x = corner(scene.at(time), 0, 1);  // (1, 0, 0) at rest
    EXPECT_LT(glm::length(x - glm::dvec3(std::cos(angle), std::sin(angle), 0.0)), 1e-7) << time;
  }
}

TEST_F(GltfAnimation, TheHierarchyIsAProductOfMatrices) {
  EXPECT_TRUE(rc::check("a chain of three moving nodes", [this] {
    const auto number = [] { return static_cast<float>(*rc::gen::inRange(-1000, 1001)) / 256.0F; };
    GltfFile file = GltfFile::square();
    file.json["nodes"] = {{{"children", {1}}}, {{"children", {2}}}, {{"mesh", 0}}};
    const double t = *rc::gen::inRange(0, 101) / 100.0;
    glm::dmat4 expected(1.0);
    for (int node = 0; node < 3; ++node) {
      std::vector<float> values[3];
      for (int i = 0; i < 8; ++i) {
        for (std::vector<float>& list : values) {
          list.push_back(number());
        }
      }
      values[0].resize(6);
      values[1].resize(6);
      const auto quaternion = [&](std::size_t at) {
        return glm::dquat(values[2][at + 3], values[2][at], values[2][at + 1], values[2][at + 2]);
      };
      RC_PRE(glm::length(quaternion(0)) > 0.1 && glm::length(quaternion(4)) > 0.1);
      animate(file, node, "translation", {0, 1}, values[0]);
      animate(file, node, "scale", {0, 1}, values[1]);
      animate(file, node, "rotation", {0, 1}, values[2]);
      glm::dvec3 translation;
      glm::dvec3 scale;
      for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        translation[i] = values[0][k] + t * (static_cast<double>(values[0][k + 3]) - values[0][k]);
        scale[i] = values[1][k] + t * (static_cast<double>(values[1][k + 3]) - values[1][k]);
      }
      const glm::dquat turn = glm::slerp(glm::normalize(quaternion(0)), glm::normalize(quaternion(4)), t);
      expected = expected * glm::translate(glm::dmat4(1.0), translation) *
                 glm::mat4_cast(glm::normalize(turn)) * glm::scale(glm::dmat4(1.0), scale);
    }
    const Scene pose = open(file).at(t);
    for (const glm::dvec3& rest : {glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)}) {
      const glm::dvec3 wanted(expected * glm::dvec4(rest, 1.0));
      double nearest = 1e300;
      for (const glm::dvec3& p : pose.positions) {
        nearest = std::min(nearest, glm::length(p - wanted));
      }
      RC_ASSERT(nearest < 1e-7 * (1.0 + glm::length(wanted)));
    }
  }));
}

/// The file without its animation, with the values of key frame `k` written into the nodes.
GltfFile baked(GltfFile file, const std::vector<std::pair<const char*, std::vector<float>>>& values) {
  file.json.erase("animations");
  for (const auto& [path, list] : values) {
    file.json["nodes"][1][path] = list;
  }
  return file;
}

TEST_F(GltfAnimation, APoseAtAKeyFrameIsTheFileWithItsValuesBitForBit) {
  const std::vector<std::vector<float>> translations = {{0.1F, 0.2F, 0.3F}, {4, 5.5F, -6}, {7, 0, 1e-3F}};
  const std::vector<std::vector<float>> rotations = {
      {0.1F, 0.7F, 0.2F, 0.6F}, {0, -0.3F, 0.9F, 0.1F}, {0.5F, 0.5F, 0.5F, 0.5F}};
  const std::vector<std::vector<float>> scales = {{1, 2, 3}, {-1, 1, 0.5F}, {0.1F, 0.1F, -0.1F}};
  for (const char* interpolation : {"STEP", "LINEAR", "CUBICSPLINE"}) {
    GltfFile file = GltfFile::square();
    file.primitive()["attributes"]["NORMAL"] = file.add_positions({0, 0, 1, 0, 0.6F, 0.8F, 0, 0, 1, 1, 0, 0});
    file.json["nodes"] = {{{"children", {1}}, {"translation", {3, 1, 2}}, {"scale", {1, 2, 1}}},
                          {{"mesh", 0}, {"translation", {9, 9, 9}}}};
    const GltfFile bare = file;
    const auto joined = [&](const std::vector<std::vector<float>>& list) {
      std::vector<float> values;
      for (const std::vector<float>& value : list) {
        const std::vector<float> tangent(value.size(), 5.0F);
        for (int part = 0; part < (interpolation[0] == 'C' ? 3 : 1); ++part) {
          const std::vector<float>& from = interpolation[0] == 'C' && part != 1 ? tangent : value;
          values.insert(values.end(), from.begin(), from.end());
        }
      }
      return values;
    };
    const std::vector<float> times = {0.125F, 1.7F, 2.9F};
    animate(file, 1, "translation", times, joined(translations), interpolation);
    animate(file, 1, "rotation", times, joined(rotations), interpolation);
    animate(file, 1, "scale", times, joined(scales), interpolation);
    const AnimatedScene scene = open(file);
    for (std::size_t k = 0; k < times.size(); ++k) {
      SCOPED_TRACE(std::string(interpolation) + " " + std::to_string(k));
      const Scene pose = scene.at(static_cast<double>(times[k]));
      const Scene still =
          open(baked(bare,
                     {{"translation", translations[k]}, {"rotation", rotations[k]}, {"scale", scales[k]}}))
              .at(0.0);
      ASSERT_EQ(pose.triangles.size(), still.triangles.size());
      for (std::size_t i = 0; i < pose.triangles.size(); ++i) {
        EXPECT_EQ(pose.triangles[i].vertex, still.triangles[i].vertex) << "mirrored alike";
      }
      for (std::size_t i = 0; i < pose.positions.size(); ++i) {
        EXPECT_TRUE(same_bits(pose.positions[i], still.positions[i]));
        EXPECT_TRUE(same_bits(pose.normals[i], still.normals[i]));
      }
      EXPECT_TRUE(moved_primitives(pose, still).empty());
    }
  }
}

/// A moving square, a still one and a mirrored one.
GltfFile three_squares() {
  GltfFile file = GltfFile::square();
  file.json["materials"] = json::array({json::object(), {{"name", "second"}}});
  file.primitive()["material"] = 1;
  file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {0.1, 0.2, 5.3}}}, {{"mesh", 0}}};
  file.json["scenes"][0]["nodes"] = {0, 1, 2};
  animate(file, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  animate(file, 2, "scale", {0, 1}, {1, 1, 1, -1, 1, 1});
  return file;
}

TEST_F(GltfAnimation, IdsMaterialsAndPolygonsAreTheSameInEveryPose) {
  const AnimatedScene scene = open(three_squares());
  const Scene first = scene.at(0.0);
  for (const double time : {0.0, 0.25, 0.5, 0.75, 1.0, 2.0}) {
    const Scene pose = scene.at(time);
    ASSERT_EQ(pose.triangles.size(), 6U);
    EXPECT_EQ(pose.polygons, first.polygons);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(pose.triangles[i].polygon, first.triangles[i].polygon);
      EXPECT_EQ(pose.triangles[i].material, first.triangles[i].material);
    }
    const std::vector<std::uint32_t> moved = moved_primitives(first, pose);
    EXPECT_EQ(moved, time == 0.0 ? std::vector<std::uint32_t>{} : (std::vector<std::uint32_t>{0, 1, 4, 5}));
    EXPECT_TRUE(moved_primitives(pose, scene.at(time)).empty()) << "the same time gives the same bits";
  }
  EXPECT_TRUE(moved_primitives(scene.at(1.0), scene.at(7.0)).empty()) << "it stands still after its end";
}

TEST_F(GltfAnimation, MirroringInOnePoseTurnsTheWindingThere) {
  const AnimatedScene scene = open(three_squares());
  const auto facing = [](const Scene& pose) {
    return glm::cross(corner(pose, 4, 1) - corner(pose, 4, 0), corner(pose, 4, 2) - corner(pose, 4, 0)).z;
  };
  EXPECT_GT(facing(scene.at(0.0)), 0.0);
  EXPECT_GT(facing(scene.at(1.0)), 0.0) << "turned round twice: by the mirroring and by the winding";
  EXPECT_LT(corner(scene.at(1.0), 4, 1).x + corner(scene.at(1.0), 4, 2).x, 0.0);
  EXPECT_TRUE(has_note(scene.at(0.5), "2 of 6 triangles have no area")) << "flat where its scale passes 0";
}

TEST_F(GltfAnimation, LightsAndCamerasRideOnTheirNodes) {
  GltfFile file = GltfFile::square();
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}}};
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 1}}}}};
  const auto h = static_cast<float>(std::sqrt(0.5));
  file.json["nodes"] = {{{"mesh", 0}},
                        {{"children", {2, 3}}},
                        {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                        {{"camera", 0}, {"translation", {0, 0, 3}}}};
  file.json["scenes"][0]["nodes"] = {0, 1};
  animate(file, 1, "translation", {0, 2}, {0, 0, 0, 4, 0, 0});
  animate(file, 2, "rotation", {0, 2}, {0, 0, 0, 1, 0, h, 0, h});
  const AnimatedScene scene = open(file);
  const Scene begin = scene.at(0.0);
  const Scene end = scene.at(2.0);
  EXPECT_EQ(begin.camera.eye, glm::dvec3(0, 0, 3));
  EXPECT_EQ(end.camera.eye, glm::dvec3(4, 0, 3));
  EXPECT_LT(glm::length(end.camera.at - end.camera.eye - glm::dvec3(0, 0, -5)), 1e-12);
  ASSERT_EQ(end.lights.size(), 1U);
  EXPECT_EQ(scene.at(1.0).lights[0].position, glm::dvec3(2, 0, 0));
  EXPECT_LT(glm::length(begin.lights[0].direction - glm::dvec3(0, 0, -1)), 1e-12);
  EXPECT_LT(glm::length(end.lights[0].direction - glm::dvec3(-1, 0, 0)), 1e-7);
  EXPECT_TRUE(moved_primitives(begin, end).empty()) << "only light and camera move";
}

TEST_F(GltfAnimation, AMadeUpViewStandsStill) {
  GltfFile file = GltfFile::square();
  animate(file, 0, "translation", {0, 1}, {100, 0, 0, 0, 0, 0});
  const AnimatedScene scene = open(file);
  const Scene begin = scene.at(0.0);
  const Scene end = scene.at(1.0);
  EXPECT_TRUE(same_bits(begin.camera.eye, end.camera.eye));
  EXPECT_EQ(begin.camera.at, glm::dvec3(100.5, 0.5, 0)) << "it frames the pose at time 0";
  EXPECT_TRUE(same_bits(begin.lights.at(0).direction, end.lights.at(0).direction));
  EXPECT_TRUE(has_note(begin, "Animation '' plays for 1 s"));
}

TEST_F(GltfAnimation, AnimationsAreChosen) {
  GltfFile file = GltfFile::square();
  animate(file, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  file.json["animations"][0]["name"] = "walk";
  json second = file.json["animations"][0];
  file.json["animations"].push_back(second);
  file.json["animations"][1]["name"] = "run";
  file.json["animations"][1]["samplers"][0]["output"] = file.add_positions({0, 0, 0, 8, 0, 0});
  const auto x = [&](const std::string& choice) {
    FileOptions options;
    options.animation = choice;
    return corner(open(file, options).at(1.0), 0, 0).x;
  };
  EXPECT_EQ(x(""), 1.0);
  EXPECT_EQ(x("walk"), 1.0);
  EXPECT_EQ(x("run"), 8.0);
  EXPECT_EQ(x("1"), 8.0);
  EXPECT_EQ(x("none"), 0.0);
  FileOptions options;
  options.animation = "wlak";
  EXPECT_NE(refusal(file, options).find("did you mean \"walk\""), std::string::npos)
      << refusal(file, options);
  options.animation = "2";
  EXPECT_NE(refusal(file, options).find("no animation '2'"), std::string::npos);
  options.animation = "none";
  EXPECT_FALSE(open(file, options).moves());
  EXPECT_TRUE(has_note(open(file, options).at(0.0), "static pose"));
  file.json["animations"][1]["name"] = "none";
  EXPECT_EQ(x("none"), 8.0) << "a name wins";

  const MotionFacts facts = open(file).facts();
  ASSERT_EQ(facts.animations.size(), 2U);
  EXPECT_EQ(facts.animations[0].name, "walk");
  EXPECT_EQ(facts.animations[1].duration, 1.0);
  EXPECT_EQ(facts.animations[0].channels, 1U);
  EXPECT_EQ(facts.chosen, 0);
  EXPECT_NE(describe(facts).find("animation 0: 'walk', 1 s, 1 channels (plays)"), std::string::npos);
}

TEST_F(GltfAnimation, OnlyTheChosenOneIsChecked) {
  GltfFile file = GltfFile::square();
  animate(file, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  file.json["animations"].push_back(file.json["animations"][0]);
  file.json["animations"][1]["samplers"][0]["input"] = 99;
  EXPECT_EQ(corner(open(file).at(1.0), 0, 0).x, 1.0);
  FileOptions options;
  options.animation = "1";
  EXPECT_NE(refusal(file, options).find("accessor 99"), std::string::npos);
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(open(file).facts()); }).find("accessor 99"),
            std::string::npos);
}

TEST_F(GltfAnimation, AChannelWithoutANodeIsIgnored) {
  GltfFile file = GltfFile::square();
  animate(file, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  animate(file, 0, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
  file.json["animations"][0]["channels"][1]["target"].erase("node");
  EXPECT_EQ(corner(open(file).at(1.0), 0, 2), glm::dvec3(2, 1, 0));
}

TEST_F(GltfAnimation, RotationsAsNormalisedIntegers) {
  GltfFile file = GltfFile::square();
  animate(file, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  const int shorts = file.add_accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0}, 5122, "VEC4", 4);
  file.json["accessors"][static_cast<std::size_t>(shorts)]["normalized"] = true;
  const Scene floats = open(file).at(0.25);
  file.json["animations"][0]["samplers"][0]["output"] = shorts;
  const Scene integers = open(file).at(0.25);
  EXPECT_TRUE(moved_primitives(floats, integers).empty());
  EXPECT_FALSE(moved_primitives(floats, open(file).at(0.0)).empty());
}

TEST_F(GltfAnimation, ABadPoseKeepsTheIds) {
  // In the middle one square is scaled beyond all bounds; a triangle that is bad at rest is in no pose.
  GltfFile file = three_squares();
  animate(file, 1, "scale", {0, 1, 2}, {1, 1, 1, 3e38F, 1, 1, 1, 1, 1});
  const AnimatedScene scene = open(file);
  const Scene first = scene.at(0.0);
  const Scene bad = scene.at(1.0);
  ASSERT_EQ(bad.triangles.size(), 6U);
  EXPECT_TRUE(has_note(bad, "2 triangles are shrunk"));
  EXPECT_FALSE(has_note(first, "shrunk"));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(bad.triangles[i].polygon, first.triangles[i].polygon);
    EXPECT_EQ(bad.triangles[i].material, first.triangles[i].material);
    const bool is_point = corner(bad, i, 0) == corner(bad, i, 1) && corner(bad, i, 0) == corner(bad, i, 2);
    EXPECT_EQ(is_point, i == 2 || i == 3) << i;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(glm::length(corner(bad, i, k)), 100.0);
    }
  }
  EXPECT_TRUE(moved_primitives(scene.at(2.0), open(three_squares()).at(2.0)).empty()) << "well again";

  file = GltfFile::square();
  animate(file, 0, "scale", {0, 1}, {1, 1, 1, 3e38F, 3e38F, 1});
  file.json["nodes"][0]["translation"] = {1, 1, 1};
  const std::string message = refusal(file, {}, 1.0);
  EXPECT_NE(message.find("none of its triangles"), std::string::npos) << message;
  EXPECT_NE(message.find("(at 1 s of animation"), std::string::npos) << message;
}

TEST_F(GltfAnimation, PosesThatCannotBe) {
  GltfFile file = GltfFile::square();
  animate(file, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  const AnimatedScene scene = open(file);
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(scene.at(std::nan(""))); }).find("finite"),
            std::string::npos);
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(scene.at(INFINITY)); }).find("finite"),
            std::string::npos);
  EXPECT_TRUE(moved_primitives(scene.at(-1e300), scene.at(0.0)).empty());
  // A spline may pass through a quaternion of no length.
  file = GltfFile::square();
  animate(file, 0, "rotation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1,  0, 0, 0, 0,  //
                                        0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0},
          "CUBICSPLINE");
  EXPECT_NE(refusal(file, {}, 0.5).find("its rotation is no unit quaternion (at 0.5 s"), std::string::npos)
      << refusal(file, {}, 0.5);
  EXPECT_EQ(refusal(file, {}, 0.25), "no UserError");
}

TEST(MovedPrimitives, NeedsTheSameNumberOfTriangles) {
  EXPECT_THROW(
      static_cast<void>(moved_primitives(open_scene("tetra:1", {}, {}), open_scene("tetra:2", {}, {}))),
      sim::InternalError);
}

}  // namespace
}  // namespace marti::scenes
