// pbrt files: what they become, and how broken and malicious ones are refused.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "loaded_scene.h"
#include "scenes/file_options.h"
#include "scenes/gltf.h"
#include "scenes/texture.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::corner;
using testing::has_note;
using testing::SceneFolder;

constexpr const char* plain_camera =
    "Scale -1 1 1\nLookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 90\n";
constexpr const char* one_triangle =
    "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"integer indices\" [ 0 1 2 ]\n";

Scene open(const std::string& world, const std::string& before = plain_camera) {
  return SceneFolder().open("a.pbrt", before + "WorldBegin\n" + world);
}
Material only_material(const std::string& statement) {
  return open(statement + one_triangle).materials.at(0);
}

TEST(Pbrt, TransformsAreThoseOfTheFormat) {
  const std::vector<std::pair<std::string, glm::dvec3>> cases = {
      {"", {1, 0, 0}},
      {"Translate 1 2 3", {2, 2, 3}},
      {"Scale 2 3 4", {2, 0, 0}},
      {"Rotate 90 0 0 1", {0, 1, 0}},
      {"Translate 1 0 0 Rotate 90 0 0 1", {1, 1, 0}},
      {"Rotate 90 0 0 1 Translate 1 0 0", {0, 2, 0}},
      {"Transform [ 0 1 0 0  -1 0 0 0  0 0 1 0  5 6 7 1 ]", {5, 7, 7}},
      {"Translate 1 0 0 ConcatTransform [ 0 1 0 0  -1 0 0 0  0 0 1 0  5 6 7 1 ]", {6, 7, 7}},
      {"Translate 9 9 9 Identity", {1, 0, 0}},
      {"Translate 9 9 9 AttributeBegin Translate 9 9 9 AttributeEnd", {10, 9, 9}},
      {"CoordinateSystem \"a\" Translate 9 9 9 CoordSysTransform \"a\" # back", {1, 0, 0}},
      {"ActiveTransform EndTime Translate 5 5 5 ActiveTransform All", {1, 0, 0}},
      {"AttributeBegin ActiveTransform EndTime Translate 5 5 5 AttributeEnd Translate +3 0 0", {4, 0, 0}},
      // The coordinates of the camera begin at its eye. They are left-handed, so that corners 1 and 2 are
      // swapped.
      {"CoordSysTransform \"camera\"", {0, 1, 5}},
  };
  for (const auto& [statements, expected] : cases) {
    const Scene scene = open(statements + "\n" + one_triangle);
    EXPECT_LT(glm::distance(corner(scene, 0, 1), expected), 1e-12) << statements;
  }
}

// pbrt sees +x to the right of an observer who looks along +z with y up; in a right-handed world it is to the
// left.
TEST(Pbrt, ACameraSeesWhatThatOfPbrtSees) {
  const Scene as_exported = open(one_triangle);
  EXPECT_EQ(corner(as_exported, 0, 1), glm::dvec3(1, 0, 0));
  EXPECT_FALSE(has_note(as_exported, "mirrored"));
  const Scene plain = open(one_triangle, "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\"\n");
  EXPECT_TRUE(has_note(plain, "mirrored in x"));
  // A mirror swaps the corners 1 and 2.
  for (const auto& [scene, right] : {std::pair(&as_exported, 1), std::pair(&plain, 2)}) {
    // A point at +x of pbrt's is in the right half of the image, whichever way the scene is written.
    const ImagePlane plane = scene->camera.image_plane(100, 100);
    EXPECT_GT(glm::dot(corner(*scene, 0, static_cast<std::size_t>(right)) - plane.origin, plane.step_x), 0.0);
    EXPECT_NEAR(glm::distance(scene->camera.eye, corner(*scene, 0, 0)), 5.0, 1e-12);
    EXPECT_FALSE(scene->framed);
  }
}

TEST(Pbrt, TheFieldOfViewIsThatOfTheShorterSide) {
  for (const auto& [film, fov] :
       {std::pair("1000", 90.0), std::pair("500", 2.0 * std::atan(2.0) * 180.0 / std::numbers::pi)}) {
    const std::string before = std::string("Film \"rgb\" \"integer xresolution\" ") + film +
                               " \"integer yresolution\" [ 1000 ]\n" + plain_camera;
    EXPECT_NEAR(open(one_triangle, before).camera.vertical_fov * 180.0 / std::numbers::pi, fov, 1e-9) << film;
  }
}

TEST(Pbrt, MaterialsAreTheWeightsOfTheirKind) {
  const Material diffuse = only_material("Material \"diffuse\" \"rgb reflectance\" [ .1 .2 .3 ]\n");
  EXPECT_EQ(diffuse.color, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(diffuse.diffuse, 1.0);
  EXPECT_EQ(diffuse.reflection, 0.0);
  const Material glass = only_material("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"\n");
  EXPECT_EQ(glass.ior, 1.5168);
  EXPECT_NEAR(glass.reflection + glass.transmission, 1.0, 1e-12);
  EXPECT_EQ(only_material("Material \"thindielectric\"\n").ior, 1.0);
  const Material gold = only_material(
      "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"\n");
  EXPECT_EQ(gold.reflection, 1.0);
  EXPECT_EQ(gold.specular_color, glm::dvec3(1.0, 0.766, 0.336));
  // Fresnel at normal incidence: ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
  const Material given = only_material("Material \"conductor\" \"rgb eta\" [ 1 2 3 ] \"rgb k\" [ 1 0 4 ]\n");
  EXPECT_LT(glm::distance(given.color, glm::dvec3(1.0 / 5.0, 1.0 / 9.0, 20.0 / 32.0)), 1e-12);
  // A roughness of 1/16 is a width of 1/4, which is one half for glTF.
  const Material rough = only_material("Material \"conductor\" \"float roughness\" 0.0625\n");
  EXPECT_NEAR(rough.reflection, 0.25, 1e-12);
  EXPECT_NEAR(only_material("Material \"conductor\" \"float roughness\" 0.25 \"bool remaproughness\" false\n")
                  .reflection,
              0.25, 1e-12);
  EXPECT_EQ(open("Material \"mix\" \"string materials\" [ \"a\" \"b\" ]\n" + std::string(one_triangle),
                 "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [ .2 .2 .2 ]\n"
                 "MakeNamedMaterial \"b\" \"string type\" \"diffuse\"\n")
                .materials.size(),
            1U);
}

TEST(Pbrt, SpectraAreColours) {
  const auto color = [](const std::string& value) {
    return only_material("Material \"diffuse\" " + value + "\n").color;
  };
  EXPECT_EQ(color("\"spectrum reflectance\" [ 300 .5 800 .5 ]"), glm::dvec3(0.5));
  const glm::dvec3 rising = color("\"spectrum reflectance\" [ 400 0 700 .75 ]");  // .0025 a nm
  EXPECT_LT(glm::distance(rising, glm::dvec3(0.625, 0.375, 0.125)), 1e-12);
  // A black body of 6,500 K is nearly white, one of 2,700 K reddish, both of luminance 1.
  for (const auto& [kelvin, white] : {std::pair("6500", true), std::pair("2700", false)}) {
    const Scene scene =
        open("AreaLightSource \"diffuse\" \"blackbody L\" " + std::string(kelvin) + "\n" + one_triangle);
    const glm::dvec3 light = scene.materials[0].emission;
    EXPECT_NEAR(glm::dot(light, glm::dvec3(0.2126, 0.7152, 0.0722)), 1.0, 2e-3);
    EXPECT_EQ(light.x / light.z < 1.2, white) << light.x << " " << light.z;
  }
}

TEST(Pbrt, ShapesAreTrianglesAndCurvedPrimitives) {
  EXPECT_EQ(open("Shape \"sphere\" \"float radius\" 2\n").quadrics.at(0).radius, 2.0);
  EXPECT_EQ(open("Scale 2 2 2 Shape \"sphere\"\n").quadrics.at(0).radius, 2.0);
  EXPECT_EQ(open("Scale 1 2 1 Shape \"sphere\"\n").triangles.size(), 528U);
  EXPECT_EQ(open("Shape \"cylinder\" \"float zmin\" 0 \"float zmax\" 3\n").quadrics.at(0).tip.z, 3.0);
  EXPECT_EQ(open("Shape \"disk\"\n").triangles.size(), 22U);
  const Scene patch = open("Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0 ]\n");
  ASSERT_EQ(patch.triangles.size(), 2U);
  EXPECT_EQ(corner(patch, 0, 2), glm::dvec3(1, 1, 0));
  EXPECT_EQ(corner(patch, 1, 1), glm::dvec3(1, 1, 0));
  const Scene curve = open("Shape \"curve\" \"point3 P\" [ 0 0 0 ]\n" + std::string(one_triangle));
  EXPECT_TRUE(has_note(curve, "Left out: 1 curves."));
}

// The outside is where a triangle's corners turn counter-clockwise, where its normals point, or the other
// side with ReverseOrientation; a mirror changes none of these.
TEST(Pbrt, SurfacesKeepTheirOutside) {
  const auto outside = [](const std::string& statements) {
    const Scene scene = open(statements);
    return glm::normalize(
        glm::cross(corner(scene, 0, 1) - corner(scene, 0, 0), corner(scene, 0, 2) - corner(scene, 0, 0)));
  };
  const std::string with_normals =
      "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"normal N\" [ 0 0 -1  0 0 -1  0 0 -1 ]\n";
  EXPECT_EQ(outside(one_triangle), glm::dvec3(0, 0, 1));
  EXPECT_EQ(outside(std::string("Scale -1 1 1 ") + one_triangle), glm::dvec3(0, 0, 1));
  EXPECT_EQ(outside(std::string("ReverseOrientation ") + one_triangle), glm::dvec3(0, 0, -1));
  EXPECT_EQ(outside(with_normals), glm::dvec3(0, 0, -1));
  EXPECT_EQ(outside("Scale 1 -1 1 " + with_normals), glm::dvec3(0, 0, -1));
}

TEST(Pbrt, InstancesAreCopiesWhereTheyStand) {
  const Scene scene = open(
      "ObjectBegin \"a\" Translate 1 0 0\n" + std::string(one_triangle) +
      "Shape \"sphere\"\nObjectEnd\nObjectInstance \"a\" AttributeBegin Scale 2 2 2 ObjectInstance \"a\" "
      "AttributeEnd\n" +
      one_triangle);
  ASSERT_EQ(scene.triangles.size(), 3U);
  ASSERT_EQ(scene.quadrics.size(), 2U);
  EXPECT_EQ(corner(scene, 0, 1), glm::dvec3(2, 0, 0));
  EXPECT_EQ(corner(scene, 1, 1), glm::dvec3(4, 0, 0));
  EXPECT_EQ(corner(scene, 2, 1), glm::dvec3(1, 0, 0));
  EXPECT_EQ(scene.quadrics[1].base, glm::dvec3(2, 0, 0));
  EXPECT_EQ(scene.polygons, 3U);
}

TEST(Pbrt, LightsShine) {
  const Scene scene = open(
      "LightSource \"point\" \"rgb I\" [ 3 6 9 ] \"float scale\" 2 \"point3 from\" [ 1 2 3 ]\n"
      "LightSource \"distant\" \"point3 from\" [ 0 5 0 ] \"point3 to\" [ 0 0 0 ]\n"
      "LightSource \"spot\" \"point3 to\" [ 1 0 0 ] \"float coneangle\" 60 \"float conedeltaangle\" 60\n"
      "LightSource \"infinite\" \"rgb L\" [ .1 .2 .3 ]\n"
      "AreaLightSource \"diffuse\" \"rgb L\" [ 5 4 3 ] \"float scale\" 2\n" +
      std::string(one_triangle));
  ASSERT_EQ(scene.lights.size(), 3U);
  EXPECT_EQ(scene.lights[0].position, glm::dvec3(1, 2, 3));
  EXPECT_LT(glm::distance(scene.lights[0].color * std::numbers::pi, glm::dvec3(6, 12, 18)), 1e-12);
  EXPECT_EQ(scene.lights[1].kind, LightKind::directional);
  EXPECT_EQ(scene.lights[1].direction, glm::dvec3(0, -1, 0));
  EXPECT_NEAR(scene.lights[2].cos_outer_cone, 0.5, 1e-12);
  EXPECT_EQ(scene.lights[2].cos_inner_cone, 1.0);
  EXPECT_EQ(scene.background, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(scene.materials[0].emission, glm::dvec3(10, 8, 6));
}

TEST(Pbrt, FilesOfTheFolderBelongToIt) {
  const SceneFolder folder;
  folder.write(
      "parts/mesh.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float u\nproperty float v\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n"
      "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n");
  folder.write("parts/shapes.pbrt",
               "Translate 1 0 0\nShape \"plymesh\" \"string filename\" \"parts/mesh.ply\"\n");
  folder.write("image.png", "an image");
  const ImageDecoder red = [](std::span<const std::byte>, std::string_view) {
    return texture_from_samples("red", 1, 1, 3, std::vector<std::uint8_t>{255, 0, 0});
  };
  const std::string file =
      "Texture \"base\" \"spectrum\" \"imagemap\" \"string filename\" \"image.png\" \"string wrap\" "
      "\"clamp\"\n"
      "Texture \"half\" \"spectrum\" \"scale\" \"texture tex\" \"base\" \"float scale\" 0.5\n"
      "Material \"diffuse\" \"texture reflectance\" \"half\"\nInclude \"parts/shapes.pbrt\"\nInclude "
      "\"parts/shapes.pbrt\"\n";
  const Scene scene = folder.open("a.pbrt", file, {}, red);
  ASSERT_EQ(scene.triangles.size(), 2U);
  EXPECT_EQ(corner(scene, 1, 0), glm::dvec3(2, 0, 0));
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_FALSE(scene.textures[0].repeat_u);
  EXPECT_EQ(scene.materials[0].color, glm::dvec3(0.5));
  EXPECT_EQ(scene.materials[0].texture, 0U);
  EXPECT_EQ(scene.uvs.at(2), glm::dvec2(0.0, 0.0)) << "v goes down";
  EXPECT_TRUE(scene.framed);
}

TEST(Pbrt, ParametersThatNothingReadsAreCounted) {
  const Scene scene = open(
      "Texture \"t\" \"spectrum\" \"constant\" \"float value\" .5 \"float vaule\" 1\n"
      "Texture \"unused\" \"spectrum\" \"constant\" \"float vaule\" 1\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\"\n \"rgb reflectence\" [ 1 0 0 ]\n"
      "Shape \"sphere\" \"float radius\" 1 \"float raduis\" 2\nShape \"sphere\"\n"
      "LightSource \"point\" \"rgb I\" [ 1 1 1 ] \"float scael\" 2\n");
  EXPECT_TRUE(
      has_note(scene, "4 parameters of pbrt that are not read here, the first 'reflectence', a.pbrt:"))
      << [&] {
           std::string all;
           for (const std::string& note : scene.notes) {
             all += note + "\n";
           }
           return all;
         }();
  EXPECT_FALSE(has_note(open(one_triangle), "are not read"));
}

TEST(Pbrt, WhatIsWrongIsSaidWithItsLine) {
  const SceneFolder folder;
  folder.write("itself.pbrt", "Include \"other.pbrt\"\n");
  folder.write("other.pbrt", "\n\nInclude \"itself.pbrt\"\n");
  folder.write("mesh.ply.gz", "compressed");
  // Three files, of which each includes the next one 150 times.
  const auto including = [](const std::string& name) {
    std::string text;
    for (int i = 0; i < 150; ++i) {
      text += "Include \"" + name + "\"\n";
    }
    return text;
  };
  folder.write("b.pbrt", including("c.pbrt"));
  folder.write("c.pbrt", "\n");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "a.pbrt: the scene has no triangles"},
      {"Shape \"cube\"", "a.pbrt:1: there is no shape 'cube'"},
      {"\n\nBox 1", "a.pbrt:3: 'Box' is no statement of a pbrt file"},
      {"Shape \"sphere", "a.pbrt:1: a quotation mark is not closed in its line"},
      {"Shape \"sphere\" \"radius\" 1", "'radius' is no parameter"},
      {"Shape \"sphere\" \"float radius\" [ 1", "the file ends where a closing bracket is expected"},
      {"Shape \"sphere\" \"float radius\" -1", "'radius' must be one number from 0 to"},
      {"Shape \"sphere\" \"float radius\" abc", "'abc' is no value of the parameter 'radius'"},
      {"Translate 1 2", "the file ends where a number is expected"},
      {"Translate 1 2 nan", "'nan' is no number up to 1e30"},
      {"Scale 1 0 1 Shape \"sphere\"", "the transform is singular"},
      {"Scale 1e29 1e29 1e29 Scale 1e29 1e29 1e29 Shape \"disk\"", "moves a point beyond 1e30"},
      {"Rotate 90 0 0 0", "an axis that is not 0"},
      {"LookAt 0 0 0 0 0 0 0 1 0", "LookAt needs a point apart from the eye"},
      {"Transform [ 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 ] Shape \"sphere\"", "the transform is not affine"},
      {"AttributeEnd", "AttributeEnd without its begin"},
      {"ActiveTransform Now", "ActiveTransform is All, StartTime or EndTime, not 'Now'"},
      {"Translate \"[\" 1 2 3 ]", "'[' is no number"},
      {"Shape \"plymesh\"", "the name of a file is missing or empty"},
      {"\nAttributeBegin\n", "a.pbrt:2: the AttributeBegin has no end"},
      {"ObjectBegin \"a\"", "the ObjectBegin has no end"},
      {"ObjectBegin \"a\" AttributeEnd", "an ObjectBegin has no ObjectEnd"},
      {"ObjectEnd", "ObjectEnd without its begin"},
      {"ObjectBegin \"a\" ObjectInstance \"a\"", "an instance lies in an object"},
      {"ObjectInstance \"a\"", "there is no object 'a' before it"},
      {"NamedMaterial \"a\"", "there is no material 'a'"},
      {"Material \"gold\"", ""},  // not used
      {"Material \"gold\" Shape \"sphere\"", "there is no type of material 'gold'"},
      {"Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
       "there is no texture 't' before it"},
      {"Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\" Material \"diffuse\" \"texture "
       "reflectance\" \"t\" "
       "Shape \"sphere\"",
       "more than 8 textures refer to each other"},
      {"Material \"diffuse\" \"rgb reflectance\" [ 1 2 3 ] Shape \"sphere\"", "it must lie in 0 to 1"},
      {"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 ]", "takes a multiple of 3"},
      {"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 inf ]", "a point of 'P' is not finite"},
      {"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]",
       "an index is none of the numbers 0 to 2"},
      {"Shape \"plymesh\" \"string filename\" \"none.ply\"", "there is no file 'none.ply'"},
      {"Shape \"plymesh\" \"string filename\" \"mesh.ply.gz\"", "is compressed"},
      {"Include \"../a.pbrt\"", "leads out of the scene's folder"},
      {"Include \"itself.pbrt\"", "other.pbrt:3: the file 'itself.pbrt' includes itself"},
      {including("b.pbrt"), "or more than 16384 are included"},
      {"LightSource \"lamp\"", "there is no kind of light 'lamp'"},
      {"LightSource \"distant\" \"point3 to\" [ 0 0 0 ]", "from a point to the same point"},
      {"Camera \"perspective\" \"float fov\" 180", "'fov' must be one number"},
  };
  for (const auto& [text, reason] : cases) {
    const std::string message = folder.refusal("a.pbrt", text + "\n");
    EXPECT_NE(message.find(reason), std::string::npos) << text << "\n" << message;
    EXPECT_TRUE(message.starts_with("a.pbrt") || message.starts_with("b.pbrt") ||
                message.starts_with("other.pbrt"))
        << message;
  }
}

TEST(Pbrt, WhatIsReplacedIsRefusedIfThatIsAskedFor) {
  const SceneFolder folder;
  for (const std::string text :
       {"Material \"hair\"\n", "Camera \"realistic\"\n", "LightSource \"goniometric\"\n",
        "Material \"diffuse\" \"spectrum reflectance\" \"file.spd\"\n"}) {
    const std::string whole = text + one_triangle;
    EXPECT_TRUE(has_note(folder.open("a.pbrt", whole), "Replaced: 1 ")) << text;
    EXPECT_TRUE(folder.refusal("a.pbrt", whole, {.strict = true}).starts_with("a.pbrt:1: ")) << text;
  }
}

// Sixteen levels of objects cannot be nested, so copies grow with the file; they are still counted before
// they are made.
TEST(Pbrt, InstancesAreCountedBeforeTheyAreMade) {
  std::string text = "ObjectBegin \"a\"\n" + std::string(one_triangle) + "ObjectEnd\n";
  for (int i = 0; i < 100; ++i) {
    text += "ObjectInstance \"a\"\n";
  }
  FileOptions few;
  few.max_triangles = 99;
  EXPECT_NE(SceneFolder().refusal("a.pbrt", text, few).find("more than 99 triangles"), std::string::npos);
}

// Shapes get pbrt's own coordinates: each face the whole texture, whatever its neighbours have.
TEST(Pbrt, MeshesWithoutCoordinatesHaveThoseOfTheFormat) {
  const SceneFolder folder;
  folder.write("a.png", "A");
  const ImageDecoder texel = [](std::span<const std::byte>, std::string_view name) {
    return texture_from_samples(name, 1, 1, 1, std::array<std::uint8_t, 1>{255});
  };
  const std::string points = "\"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0 ] ";
  for (const bool patch : {false, true}) {
    for (const bool textured : {false, true}) {
      const Scene scene = folder.open(
          "a.pbrt",
          std::string("WorldBegin\nTexture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n") +
              (textured ? "Material \"diffuse\" \"texture reflectance\" \"c\"\n" : "") +
              (patch ? "Shape \"bilinearmesh\" " + points
                     : "Shape \"trianglemesh\" " + points + "\"integer indices\" [ 0 1 2  1 3 2 ]"),
          {}, texel);
      ASSERT_EQ(scene.triangles.size(), 2U);
      EXPECT_EQ(scene.positions.size(), textured ? 6U : 4U);
      if (!textured) {
        EXPECT_TRUE(scene.uvs.empty() || scene.uvs[0] == glm::dvec2(0.0));
        continue;
      }
      // pbrt's v grows upwards, the texture's rows downwards. Of a patch a point has its own coordinates.
      for (std::size_t t = 0; t < 2; ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t vertex = scene.triangles[t].vertex[k];
          const glm::dvec3& at = scene.positions[vertex];
          const glm::dvec2 by_number = std::array<glm::dvec2, 3>{{{0, 1}, {1, 1}, {1, 0}}}[k];
          EXPECT_EQ(scene.uvs[vertex], patch ? glm::dvec2(at.x, 1.0 - at.y) : by_number) << t << ' ' << k;
        }
      }
    }
  }
}

TEST(Pbrt, AttributesAreForStatementsAfterThemUpToTheEnd) {
  const Scene scene = open(
      "AttributeBegin\nAttribute \"shape\" \"float radius\" 2\nShape \"sphere\"\n"
      "Attribute \"shape\" \"float radius\" 3\nShape \"sphere\"\nShape \"sphere\" \"float radius\" 4\n"
      "Attribute \"material\" \"rgb reflectance\" [ .25 .5 .75 ]\nMaterial \"diffuse\"\n"
      "Shape \"disk\"\nAttributeEnd\nShape \"sphere\"\n");
  ASSERT_EQ(scene.quadrics.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(scene.quadrics[i].radius, (std::array{2.0, 3.0, 4.0, 1.0})[i]);
  }
  EXPECT_EQ(glm::length(corner(scene, 0, 0)), 3.0);
  EXPECT_EQ(scene.materials[scene.triangles[0].material].color, glm::dvec3(0.25, 0.5, 0.75));
}

TEST(Pbrt, AreaLightsOfOneSideAreNoted) {
  const std::string light = "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] ";
  EXPECT_TRUE(has_note(open(light + one_triangle), "1 area lights of one side, by ones of both"));
  EXPECT_FALSE(has_note(open(light + "\"bool twosided\" true " + one_triangle), "area lights"));
}

// Spheres become triangles for the sake of instances, and only where there are some.
TEST(Pbrt, SpheresStayWhereNoInstanceIsKept) {
  FileOptions kept;
  kept.instances = Instances::kept;
  const SceneFolder folder;
  const std::string object = std::string("ObjectBegin \"a\"\n") + one_triangle + "ObjectEnd\n";
  const std::string sphere = "WorldBegin\nShape \"sphere\"\n" + object;
  const Scene none = folder.open("a.pbrt", sphere, kept);
  EXPECT_EQ(none.quadrics.size(), 1U);
  EXPECT_FALSE(has_note(none, "because instances are kept"));
  const Scene some = folder.open("a.pbrt", sphere + "Translate 1 0 0 ObjectInstance \"a\"\n", kept);
  EXPECT_TRUE(some.quadrics.empty());
  EXPECT_TRUE(has_note(some, "1 spheres and cylinders, by triangles, because instances are kept"));
}

}  // namespace
}  // namespace marti::scenes
