// Morph targets and skins, at rest and in motion, against sums and matrices written out by hand.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "animated_file.h"
#include "scenes/animated.h"
#include "scenes/gltf.h"
#include "tests/support/temporary_directory.h"

namespace marti::scenes {
namespace {

using nlohmann::json;
using testing::animate;
using testing::GltfFile;
using testing::morphing_square;
using testing::skinned_square;

class GltfDeform : public ::testing::Test {
 protected:
  AnimatedScene open(const GltfFile& file) {
    return open_gltf(file.write_glb(directory_.path(), "scene.glb"), {}, {});
  }
  test::TemporaryDirectory directory_;
};

const std::vector<glm::dvec3> at_rest = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

/// The morphing square's vertices with two weights.
std::vector<glm::dvec3> morphed_by_hand(double lift, double pull) {
  std::vector<glm::dvec3> expected = at_rest;
  for (glm::dvec3& p : expected) {
    p.z += lift;
  }
  expected[2] += pull * glm::dvec3(1, 2, 3);
  return expected;
}

void expect_near(const std::vector<glm::dvec3>& found, const std::vector<glm::dvec3>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT(glm::length(found[i] - expected[i]), 1e-6) << i;
  }
}

TEST_F(GltfDeform, MorphTargetsAddUp) {
  GltfFile file = morphing_square();
  expect_near(open(file).at(0.0).positions, at_rest);
  file.json["meshes"][0]["weights"] = {0.5, 2.0};
  expect_near(open(file).at(0.0).positions, morphed_by_hand(0.5, 2.0));
  file.json["nodes"][0]["weights"] = {-1.0, 0.25};
  expect_near(open(file).at(0.0).positions, morphed_by_hand(-1.0, 0.25));
  EXPECT_EQ(open(file).facts().morph_targets, 2U);
  EXPECT_TRUE(open(file).at(0.0).notes.size() == 2U) << "only the made up camera and light are noted";
  file.json["nodes"][0]["translation"] = {0, 0, 10};
  expect_near(open(file).at(0.0).positions, morphed_by_hand(9.0, 0.25));
}

TEST_F(GltfDeform, InstancesOfOneMeshHaveWeightsOfTheirOwn) {
  GltfFile file = morphing_square();
  file.json["meshes"][0]["weights"] = {1, 0};
  file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"weights", {0, 1}}}, {{"mesh", 0}}};
  file.json["scenes"][0]["nodes"] = {0, 1, 2};
  animate(file, 2, "weights", {0, 1}, {0, 0, 4, 2});
  std::vector<glm::dvec3> expected = morphed_by_hand(1, 0);
  for (const auto& [lift, pull] : {std::pair(0.0, 1.0), std::pair(2.0, 1.0)}) {
    const std::vector<glm::dvec3> more = morphed_by_hand(lift, pull);
    expected.insert(expected.end(), more.begin(), more.end());
  }
  const AnimatedScene scene = open(file);
  expect_near(scene.at(0.5).positions, expected);
  EXPECT_EQ(moved_primitives(scene.at(0.0), scene.at(0.5)), (std::vector<std::uint32_t>{4, 5}));
}

TEST_F(GltfDeform, WeightsFollowEveryInterpolation) {
  GltfFile file = morphing_square();
  animate(file, 0, "weights", {0, 1}, {0, 1, 2, 5}, "STEP");
  expect_near(open(file).at(0.9).positions, morphed_by_hand(0, 1));
  expect_near(open(file).at(1.0).positions, morphed_by_hand(2, 5));
  file = morphing_square();
  animate(file, 0, "weights", {0, 1}, {0, 1, 2, 5}, "LINEAR");
  expect_near(open(file).at(0.25).positions, morphed_by_hand(0.5, 2));
  // For each key frame all in-tangents, then all values, then all out-tangents. With Hermite's basis at one
  // half: (v0 + v1) / 2 + (b0 - a1) / 8.
  file = morphing_square();
  animate(file, 0, "weights", {0, 1}, {9, 9, 0, 1, 4, 8, 2, -2, 2, 5, 9, 9}, "CUBICSPLINE");
  expect_near(open(file).at(0.5).positions,
              morphed_by_hand((0 + 2) / 2.0 + (4 - 2) / 8.0, (1 + 5) / 2.0 + (8 + 2) / 8.0));
}

TEST_F(GltfDeform, NormalsAreDisplacedAndOfUnitLength) {
  GltfFile file = morphing_square();
  const std::vector<float> up = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  const std::vector<float> aside = {1, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0};
  file.primitive()["targets"][0]["NORMAL"] = file.add_positions(aside);
  file.json["nodes"][0]["weights"] = {1, 0};
  EXPECT_TRUE(open(file).at(0.0).normals.empty())
      << "without normals of the mesh those of targets do not count";
  file.primitive()["attributes"]["NORMAL"] = file.add_positions(up);
  const Scene scene = open(file).at(0.0);
  const double h = std::sqrt(0.5);
  EXPECT_LT(glm::length(scene.normals[0] - glm::dvec3(h, 0, h)), 1e-12);
  EXPECT_EQ(scene.normals[2], glm::dvec3(0.0)) << "a normal that vanishes: the triangle's own holds";
  EXPECT_EQ(scene.normals[3], glm::dvec3(0, 0, 1));
}

TEST_F(GltfDeform, AWeightOfZeroLeavesOutEvenWhatIsNotFinite) {
  GltfFile file = morphing_square();
  file.primitive()["targets"][0]["POSITION"] = file.add_positions({NAN, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  animate(file, 0, "weights", {0, 1}, {0, 0, 1, 0});
  const AnimatedScene scene = open(file);
  EXPECT_EQ(scene.at(0.0).triangles.size(), 2U);
  const std::string message = [&] {
    try {
      static_cast<void>(scene.at(1.0));
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  }();
  EXPECT_NE(message.find("none of its triangles"), std::string::npos) << "both have the bad corner";
}

TEST_F(GltfDeform, ASkinInItsBindPoseIsTheMesh) {
  expect_near(open(skinned_square()).at(0.0).positions, at_rest);
  EXPECT_EQ(open(skinned_square()).facts().skins, 1U);
}

TEST_F(GltfDeform, JointsPullAndTheMeshNodeDoesNot) {
  GltfFile file = skinned_square();
  const double h = std::sqrt(0.5);
  file.json["nodes"][1]["translation"] = {5, 0, 0};
  file.json["nodes"][2]["rotation"] = {0, 0, h, h};  // a quarter turn about its own place, (0, 1, 0)
  file.json["nodes"][0]["translation"] = {100, 100, 100};
  file.json["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene scene = open(file).at(0.0);
  // Corner (1, 1, 0) is (1, 0, 0) from the joint, so it turns to (0, 1, 0) from it.
  expect_near(scene.positions, {{5, 0, 0}, {6, 0, 0}, {5, 2, 0}, {5, 1, 0}});
  EXPECT_EQ(scene.triangles[0].vertex, (std::array<std::uint32_t, 3>{0, 1, 2})) << "nor is it mirrored";
}

TEST_F(GltfDeform, AnimatedJointsGiveTheWeightedSumOfMatrices) {
  EXPECT_TRUE(rc::check("two joints, three sets of weights", [this] {
    GltfFile file = skinned_square();
    std::vector<std::vector<double>> weights(4, std::vector<double>(2, 0.0));
    for (int set = 0; set < 3; ++set) {
      std::vector<std::uint16_t> joints;
      std::vector<float> values;
      for (std::size_t vertex = 0; vertex < 4; ++vertex) {
        for (int i = 0; i < 4; ++i) {
          joints.push_back(*rc::gen::inRange<std::uint16_t>(0, 2));
          values.push_back(static_cast<float>(*rc::gen::inRange(set == 0 ? 1 : 0, 9)));
          weights[vertex][joints.back()] += static_cast<double>(values.back());
        }
      }
      const std::string n = std::to_string(set);
      file.primitive()["attributes"]["JOINTS_" + n] = file.add_accessor(joints, 5123, "VEC4", 4);
      file.primitive()["attributes"]["WEIGHTS_" + n] = file.add_accessor(values, 5126, "VEC4", 4);
    }
    const auto number = [] { return static_cast<float>(*rc::gen::inRange(-1000, 1001)) / 256.0F; };
    const std::vector<float> place = {number(), number(), number()};
    const std::vector<float> size = {number(), number(), number()};
    animate(file, 1, "translation", {0}, place);
    animate(file, 2, "scale", {0}, size);
    const glm::dmat4 first = glm::translate(glm::dmat4(1.0), glm::dvec3(place[0], place[1], place[2]));
    const glm::dmat4 second = first * glm::translate(glm::dmat4(1.0), glm::dvec3(0, 1, 0)) *
                              glm::scale(glm::dmat4(1.0), glm::dvec3(size[0], size[1], size[2])) *
                              glm::translate(glm::dmat4(1.0), glm::dvec3(0, -1, 0));
    const Scene scene = open(file).at(0.0);
    for (std::size_t vertex = 0; vertex < 4; ++vertex) {
      const double sum = weights[vertex][0] + weights[vertex][1];
      const glm::dvec4 rest(at_rest[vertex], 1.0);
      const glm::dvec3 expected((weights[vertex][0] * (first * rest) + weights[vertex][1] * (second * rest)) /
                                sum);
      RC_ASSERT(glm::length(scene.positions[vertex] - expected) < 1e-10);
    }
  }));
}

TEST_F(GltfDeform, OneJointIsAParentBitForBit) {
  // All weight on one joint without an inverse bind matrix: the mesh hangs at the joint's node.
  GltfFile file = skinned_square();
  file.json["skins"][0].erase("inverseBindMatrices");
  file.primitive()["attributes"]["JOINTS_0"] =
      file.add_accessor(std::vector<std::uint8_t>(16, 1), 5121, "VEC4", 4);
  file.primitive()["attributes"]["NORMAL"] = file.add_positions({0, 0, 1, 0, 0.6F, 0.8F, 0, 0, 1, 1, 0, 0});
  file.json["nodes"][1]["rotation"] = {0.1, 0.2, 0.3, 0.9};
  file.json["nodes"][2]["scale"] = {0.1, 0.7, 1.3};
  const Scene skinned = open(file).at(0.0);
  file.json["nodes"][0] = json::object();
  file.json["nodes"][2]["mesh"] = 0;
  const Scene placed = open(file).at(0.0);
  EXPECT_TRUE(moved_primitives(skinned, placed).empty());
  EXPECT_EQ(skinned.normals, placed.normals);
}

TEST_F(GltfDeform, MorphingComesBeforeSkinning) {
  GltfFile file = skinned_square();
  file.primitive()["targets"] = {{{"POSITION", file.add_positions({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0})}}};
  file.json["meshes"][0]["weights"] = {1};
  file.json["nodes"][1]["scale"] = {3, 1, 1};
  expect_near(open(file).at(0.0).positions, {{3, 0, 0}, {6, 0, 0}, {6, 1, 0}, {3, 1, 0}});
}

TEST_F(GltfDeform, WeightsOfIntegersAndThoseThatDoNotAddUpToOne) {
  GltfFile file = skinned_square();
  file.json["nodes"][1]["translation"] = {7, 0, 0};
  const int bytes = file.add_accessor<std::uint8_t>(
      {255, 0, 0, 0, 200, 55, 0, 0, 128, 0, 127, 0, 255, 0, 0, 0}, 5121, "VEC4", 4);
  file.json["accessors"][static_cast<std::size_t>(bytes)]["normalized"] = true;
  file.primitive()["attributes"]["WEIGHTS_0"] = bytes;
  const std::vector<glm::dvec3> moved = {{7, 0, 0}, {8, 0, 0}, {8, 1, 0}, {7, 1, 0}};
  expect_near(open(file).at(0.0).positions, moved);
  file.primitive()["attributes"]["WEIGHTS_0"] =
      file.add_accessor<float>({0.25F, 0, 0, 0, 3, 0, 1, 0, 1, 0, 0, 0, 1e-20F, 0, 0, 0}, 5126, "VEC4", 4);
  expect_near(open(file).at(0.0).positions, moved);
}

}  // namespace
}  // namespace marti::scenes
