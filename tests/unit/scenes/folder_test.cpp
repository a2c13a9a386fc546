// A folder of files as one scene.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "scenes/gltf_export.h"
#include "scenes/procedural.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::has_note;
using testing::triangle;

const std::string points =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
    "z\nend_header\n"
    "1 2 3\n";

Scene open_all(const testing::SceneFolder& folder, const FileOptions& options = {}) {
  return open_scene(folder.path().string() + "/", {{}, options}, {});
}

// Its scene is that of its files, one after the other in the order of their names, whatever their formats.
TEST(Folder, IsItsFilesOneAfterTheOther) {
  const testing::SceneFolder folder;
  folder.write("c.mtl", "newmtl red\nKd 1 0 0\n");
  folder.write("c.obj", "mtllib c.mtl\nusemtl red\nvn 0 0 1\nv 0 0 2\nv 1 0 2\nv 0 1 2\nf 1//1 2//1 3//1\n");
  folder.write("a.obj", triangle);
  testing::GltfFile square = testing::GltfFile::square();
  square.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  square.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  folder.write("b.glb", square.glb());
  folder.write("d.PLY", points);
  folder.write("e.obj", "v 0 0 0\n");
  folder.write("notes.txt", "no scene\n");
  folder.write("inner/f.obj", "broken\n");
  FileOptions never;
  never.default_light = DefaultLight::never;
  const Scene scene = open_all(folder);
  std::size_t triangle_at = 0;
  std::size_t lights = 0;
  std::size_t materials = 0;
  std::uint64_t polygons = 0;
  for (const char* name : {"a.obj", "b.glb", "c.obj"}) {
    const Scene part = open_scene((folder.path() / name).string(), {{}, never}, {});
    for (const Triangle& own : part.triangles) {
      ASSERT_LT(triangle_at, scene.triangles.size());
      const Triangle& found = scene.triangles[triangle_at++];
      EXPECT_EQ(found.material, own.material + materials);
      EXPECT_EQ(found.polygon, own.polygon + polygons);
      EXPECT_EQ(scene.materials[found.material].color, part.materials[own.material].color);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(scene.positions[found.vertex.at(i)], part.positions[own.vertex.at(i)]);
        EXPECT_EQ(scene.normals[found.vertex.at(i)],
                  part.normals.empty() ? glm::dvec3(0.0) : part.normals[own.vertex.at(i)]);
      }
    }
    lights += part.lights.size();
    materials += part.materials.size();
    polygons += part.polygons;
  }
  EXPECT_EQ(triangle_at, scene.triangles.size());
  EXPECT_EQ(scene.normals.size(), scene.positions.size());
  EXPECT_EQ(scene.lights.size(), lights);
  EXPECT_EQ(scene.materials.size(), materials);
  EXPECT_EQ(scene.polygons, polygons);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_TRUE(has_note(scene, "Left out: 2 files without triangles: d.PLY, e.obj.")) << describe(scene);
  EXPECT_TRUE(has_note(scene, std::string("The scene has no perspective camera")));
}

// The first file that has a camera says how the scene is seen and what is behind it; a view replaces it.
TEST(Folder, HasTheFirstCamera) {
  const testing::SceneFolder folder;
  folder.write("a.obj", triangle);
  const Scene balls = make_procedural("tetra:2");
  const Scene other = make_procedural("room:2");
  export_glb(balls, folder.write("b.glb", ""));
  export_glb(other, folder.write("c.glb", ""));
  FileOptions options;
  const Scene scene = open_all(folder, options);
  EXPECT_EQ(scene.camera.eye, balls.camera.eye);
  EXPECT_EQ(scene.background, balls.background);
  EXPECT_EQ(scene.ambient, balls.ambient);
  EXPECT_EQ(scene.lights.size(), balls.lights.size() + other.lights.size());
  EXPECT_FALSE(has_note(scene, "camera"));
  options.view.eye = glm::dvec3(1.0, 2.0, 9.0);
  options.sky.sky = glm::dvec3(1.0);
  EXPECT_EQ(open_all(folder, options).camera.eye, glm::dvec3(1.0, 2.0, 9.0));
  EXPECT_EQ(open_all(folder, options).background, glm::dvec3(1.0));
}

// What is replaced in a file is counted under its name, and refused where the options say so.
TEST(Folder, NamesTheFileInNotesAndRefusals) {
  const testing::SceneFolder folder;
  folder.write("a.obj", triangle);
  folder.write("b.obj", "mtllib none.mtl\n" + triangle);
  EXPECT_TRUE(has_note(open_all(folder), "b.obj: Replaced: 1 material libraries"));
  const auto refusal = [&](const FileOptions& options = {}) {
    return test::user_error_of([&] { static_cast<void>(open_all(folder, options)); });
  };
  FileOptions strict;
  strict.strict = true;
  EXPECT_TRUE(test::says(refusal(strict), (folder.path() / "b.obj").string() + ":1: 'none.mtl'"));
  folder.write("b.obj", "f 1 2 3\n");
  EXPECT_TRUE(test::says(refusal(), (folder.path() / "b.obj").string() + ":1: ")) << refusal();
  FileOptions few;
  few.max_triangles = 4;  // each file's vertices are fewer, those of both are not
  folder.write("b.obj", triangle);
  EXPECT_TRUE(test::says(refusal(few), "its parts have more than 4 primitives of a kind or vertices"))
      << refusal(few);
  FileOptions part;
  part.camera = "0";
  EXPECT_TRUE(test::says(refusal(part), "a folder has one camera and no parts"));
}

TEST(Folder, WithoutAnySceneIsRefused) {
  const testing::SceneFolder folder;
  const auto refusal = [&](const std::string& end) {
    return test::user_error_of([&] { static_cast<void>(open_scene(folder.path().string() + end, {}, {})); });
  };
  EXPECT_TRUE(test::says(refusal("/"), "the folder cannot be read: No such file"));
  folder.write("a.txt", "");
  EXPECT_TRUE(test::says(refusal("/"), "has no file whose name ends in .gltf, .glb, .obj, .ply or .camera"));
  folder.write("a.obj", "v 0 0 0\n");
  EXPECT_TRUE(test::says(refusal("/"), "none of its 1 parts has triangles"));
  EXPECT_TRUE(test::says(refusal(""), "is a folder: write '"));
  EXPECT_TRUE(test::says(refusal("/a.txt/"), "the folder cannot be read: Not a directory"));
}

TEST(Folder, TakesWhatLiesInItAlone) {
  const testing::SceneFolder folder;
  folder.write("a.obj", triangle);
  folder.write("._a.obj", "another program's");
  folder.write("b.obj/inner.txt", "");
  EXPECT_EQ(open_all(folder).triangles.size(), 1U);
  const testing::SceneFolder other;
  other.write("secret.obj", triangle);
  std::filesystem::create_symlink(folder.path() / "a.obj", folder.path() / "c.obj");
  EXPECT_EQ(open_all(folder).triangles.size(), 2U);
  std::filesystem::create_symlink(other.path() / "secret.obj", folder.path() / "d.obj");
  EXPECT_TRUE(test::says(test::user_error_of([&] { static_cast<void>(open_all(folder)); }),
                         "the file \"d.obj\" leads out of the scene's folder"));
}

}  // namespace
}  // namespace marti::scenes
