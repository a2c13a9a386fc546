// A list of sources as one scene: where transforms put its parts, its camera, and what is refused.
#include "scenes/scene_list.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "loaded_scene.h"
#include "scenes/procedural.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::has_note;
using testing::triangle;

Scene open_list(const testing::SceneFolder& folder, const std::string& list) {
  return open_scene(list, {folder.path(), {}}, {});
}

std::string refusal(const std::string& list) {
  const testing::SceneFolder folder;
  folder.write("a.obj", triangle);
  return test::user_error_of([&] { static_cast<void>(open_list(folder, list)); });
}

/// `corner` as the words of docs/scenes.md put it: scaled, turned about x, y and z, moved.
glm::dvec3 moved(glm::dvec3 p, const glm::dvec3& scale, const glm::dvec3& degrees, const glm::dvec3& offset) {
  p *= scale;
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = degrees[axis] * 3.14159265358979323846 / 180.0;
    double& a = p[(axis + 1) % 3];
    double& b = p[(axis + 2) % 3];
    const double turned = std::cos(angle) * a - std::sin(angle) * b;
    b = std::sin(angle) * a + std::cos(angle) * b;
    a = turned;
  }
  return p + offset;
}

TEST(SceneList, IsItsFoldersAndFilesOneAfterTheOther) {
  const testing::SceneFolder folder;
  folder.write("in/a.obj", triangle);
  folder.write("in/b.obj", "v 0 0 5\nv 1 0 5\nv 0 1 5\nf 1 2 3\n");
  folder.write("c.obj", "v 0 0 7\nv 1 0 7\nv 0 1 7\nf 1 2 3\nl 1 2\n");
  folder.write("empty.obj", "v 0 0 0\n");
  const Scene scene = open_list(folder, "['c.obj', {source = 'in/'}, 'tetra:1', 'empty.obj']");
  const Scene tetra = make_procedural("tetra:1");
  ASSERT_EQ(scene.triangles.size(), 3 + tetra.triangles.size());
  EXPECT_EQ(testing::corner(scene, 0, 0).z, 7.0);
  EXPECT_EQ(testing::corner(scene, 1, 0).z, 0.0);
  EXPECT_EQ(testing::corner(scene, 2, 0).z, 5.0);
  for (std::size_t i = 0; i < tetra.triangles.size(); ++i) {
    EXPECT_EQ(testing::corner(scene, 3 + i, 1), testing::corner(tetra, i, 1));
  }
  EXPECT_EQ(scene.camera.eye, tetra.camera.eye);
  EXPECT_EQ(scene.name, "c.obj and 3 more");
  EXPECT_TRUE(has_note(scene, "c.obj: Left out: 1 statements of lines."));
  EXPECT_TRUE(has_note(scene, "1 files without triangles: empty.obj."));
}

TEST(SceneList, TransformsScaleTurnAndMove) {
  const testing::SceneFolder folder;
  folder.write("a.obj", "v 1 2 3\nv -4 5 6\nv 7 8 -9\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  const Scene at_rest = open_list(folder, "['a.obj']");
  const Scene scene = open_list(
      folder, "{source = 'a.obj', translate = [10, 20, 30], rotate = [20, -30, 100.5], scale = [2, 3, 0.5]}");
  std::vector<glm::dvec3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 expected =
        moved(testing::corner(at_rest, 0, i), {2.0, 3.0, 0.5}, {20.0, -30.0, 100.5}, {10.0, 20.0, 30.0});
    EXPECT_LT(glm::length(testing::corner(scene, 0, i) - expected), 1e-12);
  }
  // What was perpendicular to a plane stays so. A point's own plane z = const has these two directions.
  const auto turned = [&](const glm::dvec3& p) {
    return moved(p, {2.0, 3.0, 0.5}, {20.0, -30.0, 100.5}, glm::dvec3(0.0));
  };
  const glm::dvec3 normal = scene.normals.at(scene.triangles[0].vertex[0]);
  EXPECT_NEAR(glm::length(normal), 1.0, 1e-12);
  EXPECT_NEAR(glm::dot(normal, turned({1.0, 0.0, 0.0})), 0.0, 1e-12);
  EXPECT_NEAR(glm::dot(normal, turned({0.0, 1.0, 0.0})), 0.0, 1e-12);
  EXPECT_GT(glm::dot(normal, turned({0.0, 0.0, 1.0})), 0.0);
  // A matrix is written as in a book, in rows or in one go; quarter turns are exact.
  const Scene quarter = open_list(folder, "{source = 'a.obj', rotate = [0, 0, 90], translate = [1, 0, 0]}");
  for (const std::string matrix :
       {"[[0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0]]", "[0, -1, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"}) {
    const Scene same = open_list(folder, "{source = 'a.obj', matrix = " + matrix + "}");
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 p = testing::corner(at_rest, 0, i);
      EXPECT_EQ(testing::corner(same, 0, i), glm::dvec3(1.0 - p.y, p.x, p.z));
      EXPECT_EQ(testing::corner(quarter, 0, i), testing::corner(same, 0, i));
    }
  }
}

// The volume that triangles wind about counter-clockwise, as seen from outside, is positive. Recipes take
// their camera and lights with them, and spheres their radius.
TEST(SceneList, MirrorsKeepTheOuterSideAndAllOfASceneMoves) {
  const auto volume = [](const Scene& scene) {
    double sum = 0.0;
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      sum += glm::dot(testing::corner(scene, i, 0),
                      glm::cross(testing::corner(scene, i, 1), testing::corner(scene, i, 2)));
    }
    return sum / 6.0;
  };
  const testing::SceneFolder folder;
  const Scene at_rest = open_list(folder, "['tetra:2']");
  const Scene mirrored = open_list(folder, "{source = 'tetra:2', scale = [-2, 1, 1]}");
  EXPECT_NEAR(volume(mirrored), 2.0 * volume(at_rest), 1e-9 * std::abs(volume(at_rest)));
  const Scene balls = make_procedural("balls:1");
  const Scene moved = open_list(folder, "{source = 'balls:1', scale = 2, translate = [1, 0, 0]}");
  ASSERT_EQ(moved.quadrics.size(), balls.quadrics.size());
  for (std::size_t i = 0; i < balls.quadrics.size(); ++i) {
    EXPECT_EQ(moved.quadrics[i].radius, 2.0 * balls.quadrics[i].radius);
    EXPECT_EQ(moved.quadrics[i].base, 2.0 * balls.quadrics[i].base + glm::dvec3(1.0, 0.0, 0.0));
  }
  EXPECT_EQ(moved.camera.eye, 2.0 * balls.camera.eye + glm::dvec3(1.0, 0.0, 0.0));
  EXPECT_EQ(moved.lights.at(0).position, 2.0 * balls.lights.at(0).position + glm::dvec3(1.0, 0.0, 0.0));
  // Numbers of curved primitives in their source go on from part to part.
  const Scene twice = open_list(folder, "['balls:1', 'balls:1']");
  EXPECT_EQ(twice.quadrics.back().source, 2 * balls.quadrics.size() - 1);
  EXPECT_EQ(twice.quadrics.back().material, balls.materials.size() + balls.quadrics.back().material);
}

TEST(SceneList, ACameraFileIsACamera) {
  const testing::SceneFolder folder;
  folder.write("b.obj", triangle);
  folder.write("view.camera", "1 2 3\n0 0.5 -1e1\n");
  for (const std::string source : {folder.path().string() + "/", std::string("['b.obj', 'view.camera']")}) {
    const Scene scene = open_list(folder, source);
    EXPECT_EQ(scene.camera.eye, glm::dvec3(1.0, 2.0, 3.0));
    EXPECT_EQ(scene.camera.at, glm::dvec3(0.0, 0.5, -10.0));
    EXPECT_FALSE(has_note(scene, "perspective camera"));
  }
  const Scene moved =
      open_list(folder, "['b.obj', {source = 'view.camera', scale = 0.5, translate = [0, 1, 0]}]");
  EXPECT_EQ(moved.camera.eye, glm::dvec3(0.5, 2.0, 1.5));
  const std::string place = (folder.path() / "bad.camera").string();
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"1 2 3\n4 nan 6\n", ":2: a coordinate must be a number from -1e30 to 1e30, not 'nan'"},
           {"1 2 3\n4 1e31 6\n", ":2: a coordinate must be a number"},
           {"1 2 x\n", ":1: "},
           {"1 2 3\n4 5\n",
            ":2: a camera is six numbers, the eye and a point that it looks at; the file ends after 5"},
           {"1 2 3\n4 5 6\n7\n",
            ":3: a camera is six numbers, the eye and a point that it looks at; here is a seventh"},
           {"1 2 3\n1 2 3\n", ":2: "}}) {
    folder.write("bad.camera", text);
    const std::string found =
        test::user_error_of([&] { static_cast<void>(open_list(folder, "['b.obj', 'bad.camera']")); });
    EXPECT_TRUE(test::says(found, place + message)) << found;
  }
  EXPECT_TRUE(test::says(test::user_error_of([&] { static_cast<void>(open_list(folder, "view.camera")); }),
                         "is a camera by itself"));
}

TEST(SceneList, WhatIsNoListIsRefusedWithItsEntry) {
  for (const auto& [list, message] : std::vector<std::pair<std::string, std::string>>{
           {"[", "cannot be read as a list of scenes: "},
           {"['a.obj']\nscene.bogus = 1", "something follows the list"},
           {"['a.obj', nan]", "cannot be read as a list of scenes: "},
           {"[]", "a list of scenes has 1 to 65536 entries, not 0"},
           {"['a.obj', 3]", "entry 2: must be a text or a table with source, not the integer 3"},
           {"[['a.obj']]", "entry 1: must be a text or a table with source, not a list"},
           {"['[1]']", "entry 1: its source is a list itself"},
           {"['']", "entry 1: its source is empty"},
           {"{scale = 2}", "entry 1: lacks its source"},
           {"{source = 'a.obj', scal = 2}", "entry 1, a.obj: unknown key scal (did you mean \"scale\"?)"},
           {"{source = 'a.obj', scale = [1, 2]}", "scale is one number or three, not 2"},
           {"{source = 'a.obj', rotate = 90}", "rotate is three numbers, not 1"},
           {"{source = 'a.obj', rotate = ['x', 0, 0]}",
            "rotate has numbers from -1e30 to 1e30, not the text"},
           {"{source = 'a.obj', translate = [1e31, 0, 0]}", "translate has numbers from -1e30 to 1e30"},
           {"{source = 'a.obj', scale = [1, 0, 1]}", "entry 1, a.obj: its transform is singular"},
           {"{source = 'a.obj', matrix = [1, 2, 0, 0, 2, 4, 0, 0, 0, 0, 1, 0]}", "its transform is singular"},
           {"{source = 'a.obj', matrix = [[1, 0, 0, 0, 0], [1, 0, 0], [0, 0, 1, 0]]}",
            "matrix has rows of 4 numbers, not of 5"},
           {"{source = 'a.obj', matrix = [1]}", "matrix has 12 or 16 numbers, row by row, not 1"},
           {"{source = 'a.obj', matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}", "the last row of matrix"},
           {"{source = 'a.obj', scale = 2, matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0]}", "leave these out"},
           {"[{source = 'a.obj', scale = 1e30, translate = [1e30, 0, 0]}]",
            "a.obj: its transform moves a point"},
           {"{source = 'balls:1', scale = [1, 2, 1]}", "balls:1: its spheres, cylinders and cones can be"}}) {
    const std::string found = refusal(list);
    EXPECT_TRUE(test::says(found, message)) << list << ": " << found;
  }
}

TEST(SceneList, IsTheSameFromAnyDirectory) {
  EXPECT_EQ(source_from("['a.obj', {source = '/b/', scale = 2}, 'tetra:1']", "/home"),
            "['/home/a.obj', {source = '/b/', scale = 2}, 'tetra:1']");
  EXPECT_EQ(source_from("x/../a.obj", "/home"), "/home/a.obj");
  EXPECT_EQ(source_from("tetra:1", "/home"), "tetra:1");
  EXPECT_TRUE(reads_files("['tetra:1', 'in/']"));
  EXPECT_FALSE(reads_files("['tetra:1', 'gears:1']"));
}

// pbrt's camera decides whether its file is mirrored; one without a camera is not.
TEST(SceneList, SaysWhereOneFileOfPbrtIsMirroredAndAnotherIsNot) {
  const testing::SceneFolder folder;
  const std::string shape = "WorldBegin\nShape \"disk\"\n";
  folder.write("a.pbrt", "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\"\n" + shape);
  folder.write("b.pbrt", shape);
  EXPECT_TRUE(has_note(open_list(folder, R"(["a.pbrt", "b.pbrt"])"),
                       "a.pbrt is mirrored, and b.pbrt is not: they fit together where this one has scale"));
  EXPECT_FALSE(has_note(open_list(folder, R"(["a.pbrt", "a.pbrt"])"), "is not: they fit together"));
  EXPECT_FALSE(has_note(open_list(folder, R"(["b.pbrt", "b.pbrt"])"), "is not: they fit together"));
}

}  // namespace
}  // namespace marti::scenes
