// Wavefront OBJ files and their material libraries.
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "loaded_scene.h"
#include "scenes/obj.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::corner;
using testing::has_note;
using testing::SceneFolder;

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

double area(const Scene& scene) {
  double sum = 0.0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    sum += glm::cross(corner(scene, i, 1) - corner(scene, i, 0), corner(scene, i, 2) - corner(scene, i, 0)).z;
  }
  return sum / 2.0;
}

TEST(Obj, FacesCountFromTheBeginningOrTheEnd) {
  const SceneFolder folder;
  const Scene a = folder.open("a.obj", square + "f 1 2 3\nf 1 3 4\n");
  const Scene b =
      folder.open("b.OBJ", "\xef\xbb\xbf# comment\r\n" + square + "f -4 -3 -2 # here\r\nf 1 \\\r\n -2 4");
  ASSERT_EQ(a.triangles.size(), 2U);
  ASSERT_EQ(b.triangles.size(), 2U);
  EXPECT_EQ(a.polygons, 2U);
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(corner(a, t, i), corner(b, t, i));
    }
  }
  EXPECT_EQ(a.name, "a.obj");
  EXPECT_TRUE(a.normals.empty());
  EXPECT_TRUE(a.uvs.empty());
  EXPECT_TRUE(has_note(a, "no perspective camera"));
  EXPECT_TRUE(has_note(a, "no light"));
  EXPECT_EQ(a.lights.size(), 1U);
}

TEST(Obj, ACommentHasNoNextLine) {
  const SceneFolder folder;
  const Scene scene = folder.open("a.obj", "# C:\\models\\\nv 5 5 5\n" + square + "f 2 3 4\n");
  EXPECT_EQ(corner(scene, 0, 0), glm::dvec3(0.0, 0.0, 0.0));
}

TEST(Obj, ALineMayNameManyLibraries) {
  const SceneFolder folder;
  std::string names;
  for (int i = 0; i < 8; ++i) {
    const std::string name = "library_" + std::to_string(i) + std::string(30, 'x') + ".mtl";
    folder.write(name, "newmtl m" + std::to_string(i) + "\nKd 0.5 0.5 0.5\n");
    names += " " + name;
  }
  const Scene scene = folder.open("a.obj", "mtllib" + names + "\n" + square + "usemtl m7\nf 2 3 4\n");
  EXPECT_EQ(scene.materials.at(scene.triangles[0].material).name, "m7");
}

TEST(Obj, NumbersAreTheDecimalOnes) {
  const SceneFolder folder;
  const Scene scene =
      folder.open("a.obj", "v 0.1 -1e-3 +2.5 1.0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1 1 0 0\nf 1 2 3\n");
  EXPECT_EQ(corner(scene, 0, 0), glm::dvec3(0.1, -1e-3, 2.5));
  EXPECT_TRUE(has_note(scene, "Left out: 2 colours of vertices"));
  EXPECT_FALSE(has_note(scene, "weights"));
}

// Convex or not, the area is kept, and the triangles lie on the polygon's side.
TEST(Obj, PolygonsKeepTheirArea) {
  const SceneFolder folder;
  const Scene fan = folder.open("a.obj", square + "f 1 2 3 4\n");
  ASSERT_EQ(fan.triangles.size(), 2U);
  EXPECT_EQ(corner(fan, 0, 0), corner(fan, 1, 0));
  EXPECT_EQ(fan.polygons, 1U);
  // An arrow whose first corner sees not all others: a fan from there would leave the polygon.
  const Scene arrow = folder.open(
      "b.obj", "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\nf 2 3 4 1\nf 3 4 1 2\nf 4 1 2 3\n");
  EXPECT_EQ(arrow.triangles.size(), 8U);
  EXPECT_DOUBLE_EQ(area(arrow), 4.0);
  for (std::size_t i = 0; i < arrow.triangles.size(); ++i) {
    const glm::dvec3 middle = (corner(arrow, i, 0) + corner(arrow, i, 1) + corner(arrow, i, 2)) / 3.0;
    EXPECT_GT(middle.x, std::abs(middle.y - 1.0) > 1.0 ? 2.0 : 1.0 - std::abs(middle.y - 1.0));
  }
  // Regular polygons of up to the most corners, turned into each plane.
  for (const std::size_t corners : {5U, 64U, 1024U}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double turn : {1.0, -1.0}) {
        std::string text;
        std::string face = "f";
        for (std::size_t i = 0; i < corners; ++i) {
          const double angle =
              turn * 2.0 * 3.14159265358979323846 * static_cast<double>(i) / static_cast<double>(corners);
          std::array<double, 3> p{};
          p[static_cast<std::size_t>(axis + 1) % 3] = std::cos(angle);
          p[static_cast<std::size_t>(axis + 2) % 3] = std::sin(angle);
          text +=
              "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
          face += " " + std::to_string(i + 1);
        }
        const Scene scene = folder.open("c.obj", text + face + "\n");
        ASSERT_EQ(scene.triangles.size(), corners - 2);
        glm::dvec3 sum(0.0);
        for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
          const glm::dvec3 normal = glm::cross(corner(scene, i, 1) - corner(scene, i, 0),
                                               corner(scene, i, 2) - corner(scene, i, 0));
          EXPECT_GE(turn * normal[axis], -1e-6);
          sum += normal / 2.0;
        }
        const double n = static_cast<double>(corners);
        EXPECT_NEAR(sum[axis], turn * n / 2.0 * std::sin(2.0 * 3.14159265358979323846 / n), 1e-4);
      }
    }
  }
}

TEST(Obj, APolygonThatCrossesItselfIsAFanAndNoted) {
  const SceneFolder folder;
  const Scene scene = folder.open("a.obj", square + "v 2 3 0\nf 1 2 4 3\nf 1 2 3\nf 1 3 5 2 4\n");
  EXPECT_TRUE(has_note(scene, "2 of 3 polygons cross themselves"));
  EXPECT_EQ(scene.triangles.size(), 6U);
}

TEST(Obj, CornersWithEqualPartsAreOneVertex) {
  const SceneFolder folder;
  const std::string normals = "vn 0 0 2\nvn 0 3 0\nvn 0 0 0\nvt 0.25 0.25\nvt 1\n";
  const Scene scene = folder.open(
      "a.obj", square + normals + "f 1/1/1 2/2/1 3/1/1\nf 1/2/-3 3/1/1 4/1/2\nf 1//3 2//3 3//3\n");
  // Without a texture the coordinates make no difference: 1, 2, 3 with normal 1, 4 with 2, and 1, 2, 3
  // with 3.
  EXPECT_EQ(scene.positions.size(), 7U);
  ASSERT_EQ(scene.normals.size(), 7U);
  EXPECT_TRUE(scene.uvs.empty());
  const auto normal = [&](std::size_t t, std::size_t i) {
    return scene.normals[scene.triangles[t].vertex[i]];
  };
  EXPECT_EQ(normal(0, 0), glm::dvec3(0, 0, 1));
  EXPECT_EQ(scene.triangles[0].vertex[0], scene.triangles[1].vertex[0]);
  EXPECT_EQ(normal(1, 2), glm::dvec3(0, 1, 0));
  EXPECT_EQ(normal(2, 1), glm::dvec3(0, 0, 0));
}

TEST(Obj, WhatIsLeftOutIsCounted) {
  const SceneFolder folder;
  const Scene scene = folder.open(
      "a.obj", square +
                   "o thing\ng one two\ns 1\ns off\np 1\nl 1 2\nl 2 3\ncstype bezier\ndeg 3\nlod 7\n"
                   "v nan 0 0\nv 0 inf 0\nv 0 0 1e31\nf 1 2 3\nf 1 2 5\nf 1 2 6\nf 1 2 7 3\nf 1 1 2\n");
  EXPECT_TRUE(has_note(scene, "Left out: 1 statements of points"));
  EXPECT_TRUE(has_note(scene, "Left out: 2 statements of lines"));
  EXPECT_TRUE(has_note(scene, "Left out: 2 statements of free-form"));
  EXPECT_TRUE(has_note(scene, "Left out: 1 settings of the display"));
  EXPECT_TRUE(has_note(scene, "Left out: 3 of 5 polygons, because a position is not finite or beyond 1e30."));
  EXPECT_TRUE(has_note(scene, "1 of 2 triangles have no area"));
  for (const glm::dvec3& position : scene.positions) {
    EXPECT_TRUE(std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z));
  }
}

Material material_of(const SceneFolder& folder, const std::string& statements) {
  folder.write("lib/a b.mtl", "newmtl the one\n" + statements);
  const Scene scene = folder.open("a.obj", "mtllib lib/a b.mtl\n" + square + "usemtl the one\nf 1 2 3\n");
  EXPECT_EQ(scene.materials.size(), 1U);
  return scene.materials.front();
}

TEST(Obj, MaterialsAreWhittedOnes) {
  const SceneFolder folder;
  const Material plain =
      material_of(folder, "Kd 0.5 0.25 1 # colour\nKe 2 0 0\nKa 1 1 1\nNi 1.45\nd 1\nillum 2\n");
  EXPECT_EQ(plain.name, "the one");
  EXPECT_EQ(plain.color, glm::dvec3(0.5, 0.25, 1.0));
  EXPECT_EQ(plain.emission, glm::dvec3(2, 0, 0));
  EXPECT_EQ(plain.diffuse, 1.0);
  EXPECT_EQ(plain.highlight, 0.0);
  EXPECT_EQ(plain.transmission, 0.0);
  EXPECT_EQ(plain.ior, 1.0);

  const Material shiny = material_of(folder, "Kd 0.5\nKs 0.5 0.25 0\nNs 20\nillum 3\n");
  EXPECT_EQ(shiny.color, glm::dvec3(0.5));
  EXPECT_EQ(shiny.highlight, 0.5);
  EXPECT_EQ(shiny.reflection, 0.5);
  EXPECT_EQ(shiny.specular_color, glm::dvec3(1.0, 0.5, 0.0));
  EXPECT_EQ(shiny.shininess, 20.0);
  EXPECT_EQ(material_of(folder, "Ks 1 1 1\nillum 1\n").highlight, 0.0);
  EXPECT_EQ(material_of(folder, "Ks 1 1 1\nillum 2\n").reflection, 0.0);

  const Material glass = material_of(folder, "d 0.25\nNi 1.5\nillum 4\n");
  EXPECT_EQ(glass.diffuse, 0.25);
  EXPECT_EQ(glass.transmission, 0.75);
  EXPECT_EQ(glass.ior, 1.5);
  const Material leaf = material_of(folder, "Tr 0.75\nNi 1.5\nillum 2\n");
  EXPECT_EQ(leaf.transmission, 0.75);
  EXPECT_EQ(leaf.ior, 1.0);
  const Material filter = material_of(folder, "Kd 0 0 0\nKs 0.5 0.5 0.5\nTf 0.5 1 1\nNi 2\nillum 6\n");
  EXPECT_EQ(filter.transmission, 0.5);
  EXPECT_EQ(filter.ior, 2.0);
}

Texture one_texel(std::span<const std::byte> bytes, std::string_view name) {
  const std::array<std::uint8_t, 3> color = {static_cast<std::uint8_t>(bytes[0]), 0, 0};
  return texture_from_samples(name, 1, 1, 3, color);
}

TEST(Obj, TexturesLieBesideTheirLibrary) {
  const SceneFolder folder;
  folder.write("lib/pic 1.png", "A");
  folder.write("lib/2", "B");
  folder.write("lib/a.mtl",
               "newmtl a\nmap_Kd -clamp on -s 2 2 2 -bm 1 pic 1.png\nbump b.png\n"
               "newmtl b\nmap_Kd -o 1 1 2\nnewmtl c\nmap_Kd .\\pic 1.png\nnewmtl d\nmap_Kd missing.png\n");
  const std::string text = "mtllib lib\\a.mtl\nmtllib lib\\a.mtl\n" + square + "vt 0 0\nvt 1 0.25\nvt 1 1\n" +
                           "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\nusemtl c\nf 1 2 3\n";
  const Scene scene = folder.open("a.obj", text, {}, one_texel);
  ASSERT_EQ(scene.textures.size(), 3U);
  EXPECT_EQ(scene.textures[0].texels[0][0], 'A');
  EXPECT_FALSE(scene.textures[0].repeat_u);
  EXPECT_EQ(scene.textures[1].texels[0][0], 'B');
  EXPECT_TRUE(scene.textures[1].repeat_v);
  EXPECT_EQ(scene.textures[2].texels[0][0], 'A');
  EXPECT_EQ(scene.uvs[scene.triangles[0].vertex[1]], glm::dvec2(1.0, 0.75));  // v goes down here
  EXPECT_TRUE(has_note(scene, "Left out: 1 options -s of textures"));
  EXPECT_TRUE(has_note(scene, "Left out: 1 statements bump of materials"));
  EXPECT_TRUE(has_note(scene, "1 textures on faces without texture coordinates"));

  // What no face uses is read only when it is asked for.
  FileOptions all;
  all.read_unused = true;
  all.strict = true;
  const std::string missing = folder.refusal("a.obj", text, all, one_texel);
  EXPECT_EQ(missing.rfind("lib/a.mtl:9: 'lib/missing.png' cannot be read", 0), 0U) << missing;
  FileUse use;
  static_cast<void>(open_scene(folder.write("a.obj", text).string(), {}, one_texel, &use));
  ASSERT_EQ(use.parts.size(), 1U);
  EXPECT_EQ(use.parts[0].all, 4U);
  EXPECT_EQ(use.parts[0].used, 3U);
}

TEST(Obj, LibrariesAndTexturesLieInTheScenesFolder) {
  const SceneFolder folder;
  folder.write("../outside.mtl", "newmtl a\n");
  folder.write("../outside.png", "A");
  std::filesystem::create_symlink(folder.outside() / "outside.mtl", folder.path() / "link.mtl");
  const std::string absolute = (folder.outside() / "outside.mtl").string();
  for (const std::string& name : {std::string("../outside.mtl"), std::string("..\\outside.mtl"),
                                  std::string("link.mtl"), absolute, "file:" + absolute}) {
    const std::string message = folder.refusal("a.obj", square + "mtllib " + name + "\nf 1 2 3\n");
    EXPECT_EQ(message.rfind("a.obj:5: the file name \"", 0), 0U) << message;
    EXPECT_NE(message.find("leads out of the scene's folder"), std::string::npos) << message;
  }
  folder.write("a.mtl", "newmtl a\nmap_Kd ../outside.png\n");
  const std::string message =
      folder.refusal("a.obj", square + "mtllib a.mtl\nusemtl a\nf 1 2 3\n", {}, one_texel);
  EXPECT_EQ(message.rfind("a.mtl:2: the file name \"../outside.png\" leads out", 0), 0U) << message;
}

TEST(Obj, PartsOfAFileCannotBeChosen) {
  const SceneFolder folder;
  FileOptions options;
  options.camera = "left";
  EXPECT_NE(folder.refusal("a.obj", square + "f 1 2 3\n", options).find("an OBJ file has one camera"),
            std::string::npos);
  options = {};
  options.time = 1.0;
  EXPECT_NE(folder.refusal("a.obj", square + "f 1 2 3\n", options).find("no animation plays"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::scenes
