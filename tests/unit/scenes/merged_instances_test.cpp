// Kept objects of pbrt files and kept instances of scenes in lists: they are what copies of them are.
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "scenes/open.h"
#include "scenes/tessellate.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::GltfFile;
using testing::has_note;
using testing::SceneFolder;
using testing::sorted_triangles;

constexpr const char* shape_in_file =
    "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"normal N\" [ 0 0 1  0 0 1  0 .6 .8 ]\n";
/// An object in three places, a triangle of no object among them, and an object that shines.
const std::string objects =
    "AttributeBegin Translate 3 0 0 ObjectBegin \"a\" Rotate 30 1 1 0\n" + std::string(shape_in_file) +
    "Translate 0 0 1\n" + shape_in_file + "ObjectEnd AttributeEnd\nObjectInstance \"a\"\n" + shape_in_file +
    "AttributeBegin Scale -2 2 3 ObjectInstance \"a\" AttributeEnd\n"
    "AttributeBegin Translate 0 5 0 ObjectInstance \"a\"\n"
    "ObjectBegin \"b\" AreaLightSource \"diffuse\"\n" +
    shape_in_file + "ObjectEnd ObjectInstance \"b\" ObjectInstance \"b\" AttributeEnd\n";

FileOptions with(Instances instances) {
  FileOptions options;
  options.instances = instances;
  return options;
}

Scene open_pbrt(const std::string& world, Instances instances, const std::string& before = {}) {
  return SceneFolder().open("a.pbrt", before + "WorldBegin\n" + world, with(instances));
}

void expect_copies(const Scene& kept, const Scene& copied) {
  EXPECT_FALSE(kept.instances.empty());
  EXPECT_TRUE(copied.instances.empty());
  EXPECT_EQ(sorted_triangles(copied_instances(kept)), sorted_triangles(copied));
}

TEST(MergedInstances, ObjectsOfPbrtAreWhatCopiesAre) {
  for (const char* const camera : {"", "LookAt 0 0 9  0 0 0  0 1 0\nCamera \"perspective\"\n",
                                   "Scale -1 1 1 LookAt 0 0 9  0 0 0  0 1 0\nCamera \"perspective\"\n"}) {
    const Scene kept = open_pbrt(objects, Instances::kept, camera);
    expect_copies(kept, open_pbrt(objects, Instances::copied, camera));
    EXPECT_EQ(kept.instances.size(), 4U);
    EXPECT_EQ(kept.meshes.front().count, 3U);  // of no object, and twice the one that shines
    EXPECT_EQ(kept.triangles.size(), 5U);
    EXPECT_TRUE(has_note(kept, "4 of 2 meshes stand for 9 triangles"));
    EXPECT_FALSE(has_note(kept, "because instances are kept"));
    const Scene copied = open_pbrt(objects, Instances::automatic, camera);
    EXPECT_TRUE(copied.instances.empty());
    EXPECT_FALSE(has_note(copied, "because instances are kept"));
  }
}

TEST(MergedInstances, ALaterObjectMayTakeANameAndRoundShapesBecomeTriangles) {
  const std::string text =
      "ObjectBegin \"a\" Shape \"sphere\" ObjectEnd Translate 1 0 0 ObjectInstance \"a\"\n"
      "ObjectBegin \"a\"\n" +
      std::string(shape_in_file) + "ObjectEnd Translate 5 0 0 ObjectInstance \"a\" Shape \"cylinder\"\n";
  const Scene kept = open_pbrt(text, Instances::kept);
  EXPECT_TRUE(kept.quadrics.empty());
  EXPECT_TRUE(has_note(kept, "Replaced: 2 spheres and cylinders, by triangles"));
  ASSERT_EQ(kept.meshes.size(), 3U);
  EXPECT_EQ(kept.meshes[0].count, 48U);
  EXPECT_EQ(kept.meshes[1].count, 528U);
  EXPECT_EQ(kept.meshes[2].count, 1U);
}

TEST(MergedInstances, ManyCopiesAreKept) {
  // 4,001 sheets of 1,000 triangles.
  std::string points;
  std::string corners;
  for (int i = 0; i < 1002; ++i) {
    points += std::to_string(i / 2) + " " + std::to_string(i % 2) + " 0 ";
    corners +=
        i < 1000 ? std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + " " : "";
  }
  std::string text = "ObjectBegin \"a\" Shape \"trianglemesh\" \"point3 P\" [ " + points +
                     "] \"integer indices\" [ " + corners + "] ObjectEnd\n";
  for (int i = 0; i < 4001; ++i) {
    text += "ObjectInstance \"a\" Translate 0 0 1\n";
  }
  const Scene scene = open_pbrt(text, Instances::automatic);
  EXPECT_EQ(scene.instances.size(), 4001U);
  EXPECT_EQ(scene.triangles.size(), 1000U);
}

TEST(MergedInstances, AListHasThoseOfItsParts) {
  const SceneFolder folder;
  folder.write("a.pbrt", "WorldBegin\n" + objects);
  GltfFile file = GltfFile::square();
  file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {1, 2, 3}}}};
  file.json["scenes"] = {{{"nodes", {0, 1}}}};
  static_cast<void>(file.write_glb(folder.path(), "b.glb"));
  const std::string list =
      "['tetra:1', {source = 'b.glb', translate = [0, 0, 7]}, {source = 'a.pbrt', rotate = [10, 20, 30], "
      "scale = "
      "[1, -2, 1]}, 'b.glb', 'balls:1']";
  const auto open = [&](Instances instances) {
    return open_scene(list, {folder.path(), with(instances)}, {});
  };
  const Scene kept = open(Instances::kept);
  EXPECT_EQ(kept.meshes.size(), 4U);
  EXPECT_EQ(kept.instances.size(), 1U + 2 + 3 + 2);
  EXPECT_TRUE(has_note(kept, "spheres, cylinders and cones became triangles"));
  Scene copied = open(Instances::copied);
  const std::size_t without_balls = copied.triangles.size();
  tessellate(copied);
  EXPECT_GT(copied.triangles.size(), without_balls);
  expect_copies(kept, copied);
  EXPECT_EQ(kept.lights.size(), copied.lights.size());
  const std::string refusal = test::user_error_of([&] {
    static_cast<void>(open_scene("{source = 'b.glb', matrix = [1, -1, 0, 0, 5e3, 5e3, 0, 0, 0, 0, 1, 0]}",
                                 {folder.path(), with(Instances::kept)}, {}));
  });
  EXPECT_TRUE(test::says(refusal, "b.glb: after its transform, an instance cannot be kept")) << refusal;
}

}  // namespace
}  // namespace marti::scenes
