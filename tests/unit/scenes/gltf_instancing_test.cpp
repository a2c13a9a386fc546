// Nodes whose mesh stands in many places (EXT_mesh_gpu_instancing): they are what a node for each place is.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/scenes/loaded_scene.h"

namespace marti::scenes::testing {
namespace {

constexpr const char* extension = "EXT_mesh_gpu_instancing";

/// A square in a node that is moved, with a light and a child of its own.
GltfFile with_a_light() {
  GltfFile file = GltfFile::square();
  file.json["extensionsUsed"] = {"KHR_lights_punctual"};
  file.json["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
  file.json["nodes"] = {{{"mesh", 0},
                         {"translation", {1, 2, 3}},
                         {"scale", {2, 1, 1}},
                         {"children", {1}},
                         {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                        {{"mesh", 0}, {"translation", {0, 0, 9}}}};
  return file;
}

/// The square in three places, turned by half as much as sevenths of a circle, one of them mirrored.
GltfFile in_three_places() {
  GltfFile file = with_a_light();
  std::vector<std::int16_t> turns;
  for (int i = 0; i < 3; ++i) {
    const double half = 3.14159265358979 * i / 7.0;
    turns.insert(turns.end(), {0, 0, static_cast<std::int16_t>(std::lround(32767 * std::sin(half))),
                               static_cast<std::int16_t>(std::lround(32767 * std::cos(half)))});
  }
  const int rotations = file.add_accessor(turns, 5122, "VEC4", 4);
  file.json["accessors"][static_cast<std::size_t>(rotations)]["normalized"] = true;
  const nlohmann::json attributes = {{"TRANSLATION", file.add_positions({0, 0, 0, 4, 0, 0, 0, 4, 0})},
                                     {"ROTATION", rotations},
                                     {"SCALE", file.add_positions({1, 1, 1, 2, 3, 1, -1, 1, 1})},
                                     {"_NUMBER", file.add_accessor<float>({1, 2, 3}, 5126, "SCALAR", 1)}};
  file.json["nodes"][0]["extensions"][extension]["attributes"] = attributes;
  file.json["extensionsRequired"] = {extension};
  return file;
}

/// The same scene with a node for each place.
GltfFile in_three_nodes() {
  GltfFile file = with_a_light();
  nlohmann::json& nodes = file.json["nodes"];
  nodes[0].erase("mesh");
  const double moves[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const double scales[3][3] = {{1, 1, 1}, {2, 3, 1}, {-1, 1, 1}};
  for (int i = 0; i < 3; ++i) {
    const double half = 3.14159265358979 * i / 7.0;
    nodes[0]["children"].push_back(nodes.size());
    nodes.push_back(
        {{"mesh", 0},
         {"translation", moves[i]},
         {"rotation",
          {0, 0, std::round(32767 * std::sin(half)) / 32767.0, std::round(32767 * std::cos(half)) / 32767.0}},
         {"scale", scales[i]}});
  }
  return file;
}

class GltfInstancing : public ::testing::Test {
 protected:
  [[nodiscard]] AnimatedScene open(const GltfFile& file, Instances instances = Instances::copied) const {
    FileOptions options;
    options.instances = instances;
    return open_gltf(file.write_glb(directory_.path(), "scene.glb"), options, {});
  }
  [[nodiscard]] std::string refusal(const GltfFile& file) const {
    return test::user_error_of([&] { static_cast<void>(open(file)); });
  }

 private:
  test::TemporaryDirectory directory_;
};

TEST_F(GltfInstancing, PlacesAreWhatNodesAre) {
  const Scene nodes = open(in_three_nodes()).at(0.0);
  const Scene places = open(in_three_places()).at(0.0);
  EXPECT_EQ(places.triangles.size(), 8U);
  EXPECT_EQ(sorted_triangles(places), sorted_triangles(nodes));
  EXPECT_EQ(places.lights.size(), 1U);  // a place has its node's mesh and not its light
  EXPECT_FALSE(has_note(places, extension));
  const Scene kept = open(in_three_places(), Instances::kept).at(0.0);
  EXPECT_EQ(kept.triangles.size(), 2U);
  EXPECT_EQ(kept.instances.size(), 4U);
  EXPECT_EQ(sorted_triangles(copied_instances(kept)), sorted_triangles(nodes));
}

TEST_F(GltfInstancing, PlacesMoveWithTheirNode) {
  const auto moved = [](GltfFile file) {
    const int times = file.add_accessor<float>({0, 1}, 5126, "SCALAR", 1);
    const int values = file.add_positions({1, 2, 3, -5, 2, 3});
    file.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", values}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    return file;
  };
  const AnimatedScene places = open(moved(in_three_places()));
  const AnimatedScene nodes = open(moved(in_three_nodes()));
  ASSERT_TRUE(places.moves());
  EXPECT_EQ(sorted_triangles(places.at(0.5)), sorted_triangles(nodes.at(0.5)));
  EXPECT_NE(sorted_triangles(places.at(0.5)), sorted_triangles(places.at(0.0)));
}

TEST_F(GltfInstancing, WithoutAMeshItStandsForNothing) {
  GltfFile file = in_three_places();
  file.json["nodes"][0].erase("mesh");
  EXPECT_EQ(open(file).at(0.0).triangles.size(), 2U);
}

TEST_F(GltfInstancing, BadPlacesAreRefused) {
  const auto refusal_of = [this](const auto& change) {
    GltfFile file = in_three_places();
    change(file, file.json["nodes"][0]["extensions"][extension]["attributes"]);
    return refusal(file);
  };
  using Json = nlohmann::json;
  const std::vector<std::pair<std::string, std::string>> faults = {
      {refusal_of([](GltfFile&, Json& attributes) { attributes = 3; }),
       "node 0: its EXT_mesh_gpu_instancing has no"},
      {refusal_of([](GltfFile&, Json& attributes) { attributes = Json::object(); }), "has no attributes"},
      {refusal_of([](GltfFile&, Json& attributes) { attributes["SCALE"] = 77; }), "SCALE"},
      {refusal_of([](GltfFile&, Json& attributes) { attributes["SCALE"] = "two"; }), "SCALE"},
      {refusal_of([](GltfFile& file, Json& attributes) {
         attributes["SCALE"] = file.add_positions({1, 1, 1});
       }),
       "of 3 and of 1 places"},
      {refusal_of([](GltfFile&, Json& attributes) { attributes["SCALE"] = attributes["ROTATION"]; }),
       "SCALE"},
      {refusal_of([](GltfFile& file, Json&) { file.json["accessors"][2]["count"] = 40000000; }), "places"},
      {refusal_of([](GltfFile& file, Json& attributes) {
         attributes["ROTATION"] =
             file.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1}, 5126, "VEC4", 4);
       }),
       "the rotation of place 1 is no unit quaternion"},
      {refusal_of([](GltfFile& file, Json& attributes) {
         attributes["TRANSLATION"] = file.add_positions({0, 0, 0, 0, INFINITY, 0, 0, 0, 0});
       }),
       "is not finite"},
      {refusal_of([](GltfFile& file, Json&) {
         file.json["nodes"][0]["skin"] = 0;
         file.json["skins"] = {{{"joints", {1}}}};
       }),
       "a mesh with a skin"}};
  for (const auto& [message, part] : faults) {
    EXPECT_NE(message.find(part), std::string::npos) << message << "\nwithout " << part;
  }
}

}  // namespace
}  // namespace marti::scenes::testing
