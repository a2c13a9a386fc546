// Files as people have them: with parts that are missing or that the format does not allow, which are
// replaced with a note that counts them, and refused where the options say so. docs/scenes.md lists the
// kinds.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::GltfFile;
using testing::has_note;

/// Decodes nothing but images that begin with "A".
Texture letters(std::span<const std::byte> bytes, std::string_view name) {
  if (bytes[0] != std::byte{'A'}) {
    throw sim::UserError("it is no image");
  }
  return texture_from_samples(name, 1, 1, 3, std::array<std::uint8_t, 3>{1, 2, 3});
}

struct Kind {
  std::string bytes;
  std::string note;     ///< "Replaced: ..."
  std::string refusal;  ///< a part of the message with FileOptions::strict
};

/// Opens each with its two triangles and one note; with `strict` refuses each.
void expect_replaced(const testing::SceneFolder& folder, const std::string& name,
                     const std::vector<Kind>& kinds) {
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.note);
    Scene scene;
    EXPECT_NO_THROW(scene = folder.open(name, kind.bytes, {}, letters))
        << folder.refusal(name, kind.bytes, {}, letters);
    EXPECT_EQ(scene.triangles.size(), 2U);
    std::size_t replaced = 0;
    for (const std::string& note : scene.notes) {
      replaced += note.starts_with("Replaced: ") ? 1U : 0U;
    }
    EXPECT_EQ(replaced, 1U);
    EXPECT_TRUE(has_note(scene, "Replaced: " + kind.note)) << describe(scene);
    for (const Material& material : scene.materials) {
      EXPECT_TRUE(material.texture == no_texture || material.texture < scene.textures.size());
    }
    FileOptions strict;
    strict.strict = true;
    const std::string refusal = folder.refusal(name, kind.bytes, strict, letters);
    EXPECT_NE(refusal.find(kind.refusal), std::string::npos) << refusal;
  }
}

TEST(Replaced, OfObj) {
  const testing::SceneFolder folder;
  folder.write("twice.mtl", "newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n");
  folder.write("nameless.mtl", "newmtl\nKd 1 0 0\n");
  folder.write("options.mtl", "newmtl a\nmap_Kd -type sphere a.png\n");
  folder.write("space.mtl", "newmtl a\nmap_Kd -colorspace sRGB a.png\n");
  folder.write("none.mtl", "newmtl a\nmap_Kd none.png\n");
  folder.write("bad.mtl", "newmtl a\nmap_Kd bad.png\n");
  folder.write("unnamed.mtl", "newmtl a\nmap_Kd -clamp on\n");
  folder.write("a.png", "A");
  folder.write("bad.png", "B");
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
  const std::string face = "f 1 2 3 4\n";
  const auto with = [&](const std::string& library) {
    return "mtllib " + library + "\nusemtl a\n" + square + face;
  };
  expect_replaced(
      folder, "a.obj",
      {{"mtllib missing.mtl\n" + square + face, "1 material libraries that cannot be read, by none",
        "a.obj:1: 'missing.mtl' cannot be read"},
       {"mtllib\n" + square + face, "1 statements mtllib without a file's name", "mtllib needs the name"},
       {"usemtl other\n" + square + face,
        "1 statements usemtl of a material that no library has, by matt grey",
        "there is no material 'other'"},
       {with("twice.mtl"), "1 further definitions of a material's name, by the first",
        "defined a second time"},
       {"mtllib nameless.mtl\nusemtl\n" + square + face, "1 materials without a name", "newmtl needs a name"},
       {square + "f 1//1 2//1 3//2 4//3\n", "2 normals of corners that are not given, by the face's own",
        "normal 2, but 1 are given"},
       {square + "f 1/1 2/2 3/1 4/1\n", "1 texture coordinates of corners that are not given",
        "texture coordinate 2, but 1 are given"},
       {with("options.mtl"), "1 options -type of textures", "no option '-type'"},
       {with("space.mtl"), "1 options -colorspace of textures", "no option '-colorspace'"},
       {with("none.mtl"), "1 textures that cannot be read, by none", "none.mtl:2: 'none.png' cannot be read"},
       {with("bad.mtl"), "1 textures that cannot be decoded, by none", "it is no image"},
       {with("unnamed.mtl"), "1 textures without a file's name, by none", "map_Kd needs the name"}});

  EXPECT_EQ(folder.open("a.obj", with("twice.mtl")).materials[0].color, glm::dvec3(1, 0, 0));
  EXPECT_EQ(folder.open("a.obj", "mtllib nameless.mtl\nusemtl\n" + square + face).materials[0].color,
            glm::dvec3(1, 0, 0));
  // A face without one of its normals has none, and a later face has its own.
  const Scene normals = folder.open("a.obj", square + "f 1//1 2//1 3//9\nf 1//1 2//1 3//1\n");
  EXPECT_EQ(normals.normals[normals.triangles[0].vertex[0]], glm::dvec3(0.0));
  EXPECT_EQ(normals.normals[normals.triangles[1].vertex[0]], glm::dvec3(0, 0, 1));
  // Options of textures end where the name begins.
  EXPECT_EQ(folder.open("a.obj", with("options.mtl"), {}, letters).textures.size(), 1U);
}

/// The text, which is ASCII but for "\xe4", in UTF-16.
std::string utf16(const std::string& text, bool little) {
  std::string result = little ? "\xff\xfe" : "\xfe\xff";
  for (const char c : text) {
    result += little ? std::string{c, '\0'} : std::string{'\0', c};
  }
  return result;
}

TEST(Replaced, EncodingsOfText) {
  const testing::SceneFolder folder;
  const std::string text = "mtllib a.mtl\r\nusemtl \xe4\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nf 1 2 3\r\n";
  FileOptions strict;
  strict.strict = true;
  for (const bool little : {false, true}) {
    folder.write("a.mtl", utf16("newmtl \xe4\r\nKd 1 0 0\r\n", little));
    const Scene scene = folder.open("a.obj", utf16(text, little), strict);
    EXPECT_EQ(scene.materials[0].name, "\xc3\xa4");
    EXPECT_EQ(scene.materials[0].color, glm::dvec3(1, 0, 0));
    // Pairs of surrogates, halves of one, and half a unit at the end.
    const std::string face = utf16("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\no ", little);
    for (const std::string& rest :
         {std::string("\x3d\xd8\x00\xde", 4), std::string("\xd8\x3d\xde\x00", 4), std::string("\xd8\x00", 2),
          std::string("\x00\xd8", 2), std::string("x")}) {
      EXPECT_EQ(folder.refusal("a.obj", face + rest, strict), "no UserError");
    }
  }
  folder.write("a.mtl", "\xef\xbb\xbfnewmtl \xe4\nKd 1 0 0\n");
  EXPECT_EQ(folder.refusal("a.obj", "\xef\xbb\xbf" + text, strict), "no UserError");
}

GltfFile textured() {
  GltfFile file = GltfFile::square();
  const int coordinates = file.add_accessor(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 2);
  file.primitive()["attributes"]["TEXCOORD_0"] = coordinates;
  file.primitive()["material"] = 0;
  file.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  file.json["textures"] = {{{"source", 0}}};
  file.json["images"] = {{{"bufferView", file.add_view(std::vector<char>{'A'})}, {"mimeType", "image/png"}}};
  return file;
}

TEST(Replaced, OfGltf) {
  const testing::SceneFolder folder;
  std::vector<Kind> kinds;
  const auto add = [&](GltfFile file, const std::function<void(GltfFile&)>& damage, const std::string& note,
                       const std::string& refusal) {
    damage(file);
    kinds.push_back({file.glb(), note, refusal});
  };
  for (const char* extension :
       {"KHR_materials_unlit", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_variants",
        "KHR_materials_clearcoat", "KHR_materials_sheen", "KHR_materials_volume"}) {
    add(textured(), testing::put("/extensionsRequired", {extension}),
        std::string("1 required extensions ") + extension + ", by what the file has without it",
        std::string("requires the extension \"") + extension);
  }
  const std::string no_image = "1 textures that are missing or cannot be decoded, by none";
  add(textured(), testing::put("/images/0", {{"uri", "none.png"}}), no_image,
      "missing, empty or cannot be read");
  add(textured(), testing::put("/textures/0", nlohmann::json::object()), no_image,
      "texture 0 refers to image -1");
  add(
      textured(),
      [](GltfFile& file) { file.json["images"][0]["bufferView"] = file.add_view(std::vector<char>{'B'}); },
      no_image, "it is no image");
  add(
      textured(),
      [](GltfFile& file) {
        file.json["samplers"] = {{{"wrapS", 12345}, {"wrapT", 10497}}};
        file.json["textures"][0]["sampler"] = 0;
      },
      "1 wrap modes of textures that glTF does not have, by repeating", "no wrap mode 12345");
  add(
      textured(),
      [](GltfFile& file) {
        file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 0}}};
        file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
      },
      "1 ranges of lights that are 0, by none", "its range is 0");
  const std::string twice =
      "nodes that a scene lists twice or although they are children, by one in its place";
  add(
      textured(),
      [](GltfFile& file) {
        file.json["nodes"] = {
            {{"children", {1}}, {"translation", {5, 0, 0}}}, {{"children", {2}}}, {{"mesh", 0}}};
        file.json["scenes"][0]["nodes"] = {2, 0, 1};
      },
      "2 " + twice, "is listed in scene 0 twice");
  add(textured(), testing::put("/scenes/0/nodes", {0, 0}), "1 " + twice, "is listed in scene 0 twice");
  const std::string unpadded = "1 binary glTF files whose chunks do not end on multiples of 4 bytes";
  for (int more = 1; more < 4; ++more) {
    for (const bool binary : {false, true}) {
      std::string bytes = textured().glb();
      const auto lengthen = [&](std::size_t at) {
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + at, sizeof length);
        length += static_cast<std::uint32_t>(more);
        std::memcpy(bytes.data() + at, &length, sizeof length);
        return length;
      };
      std::uint32_t json = 0;
      std::memcpy(&json, bytes.data() + 12, sizeof json);
      lengthen(8);
      if (binary) {
        lengthen(20 + json);
        bytes.append(static_cast<std::size_t>(more), '\0');
      } else {
        lengthen(12);
        bytes.insert(20 + json, static_cast<std::size_t>(more), ' ');
      }
      kinds.push_back({bytes, unpadded, "does not end on a multiple of 4 bytes"});
    }
  }
  expect_replaced(folder, "a.glb", kinds);

  // A node under its parent is placed by it; one whose parent the scene does not list is there all the same.
  GltfFile file = GltfFile::square();
  file.json["nodes"] = {{{"children", {1}}, {"translation", {5, 0, 0}}}, {{"mesh", 0}}};
  file.json["scenes"][0]["nodes"] = {1, 0};
  EXPECT_EQ(testing::corner(folder.open("a.glb", file.glb()), 0, 0), glm::dvec3(5, 0, 0));
  file.json["scenes"][0]["nodes"] = {1};
  EXPECT_EQ(testing::corner(folder.open("a.glb", file.glb()), 0, 0), glm::dvec3(0, 0, 0));
}

TEST(Replaced, ExtensionsOfTexturesAreRead) {
  const testing::SceneFolder folder;
  FileOptions strict;
  strict.strict = true;
  GltfFile webp = textured();
  webp.json["extensionsRequired"] = {"EXT_texture_webp"};
  webp.json["textures"][0] = {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}};
  EXPECT_EQ(folder.open("a.glb", webp.glb(), strict, letters).textures.size(), 1U);

  // Scaled by (2, 3), a quarter turn counter-clockwise as seen, moved: (u, v) becomes (3 v, -2 u) + offset.
  GltfFile moved = textured();
  moved.json["extensionsRequired"] = {"KHR_texture_transform"};
  moved.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
            ["KHR_texture_transform"] = {
      {"offset", {0.5, 0.25}}, {"rotation", 1.5707963267948966}, {"scale", {2, 3}}};
  const Scene scene = folder.open("a.glb", moved.glb(), strict, letters);
  ASSERT_EQ(scene.uvs.size(), 4U);
  const std::array<glm::dvec2, 4> before = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(scene.uvs[i].x, 3.0 * before.at(i).y + 0.5, 1e-15);
    EXPECT_NEAR(scene.uvs[i].y, -2.0 * before.at(i).x + 0.25, 1e-15);
  }
  auto& given = moved.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"];
  given["KHR_texture_transform"]["texCoord"] = 3;
  EXPECT_TRUE(has_note(folder.open("a.glb", moved.glb(), {}, letters), "without the texture coordinates"));
  for (const nlohmann::json& wrong : {nlohmann::json{1}, nlohmann::json("x"), nlohmann::json{1, 2, 3},
                                      nlohmann::json{1e300, 0}, nlohmann::json{"1", 0}}) {
    given["KHR_texture_transform"] = {{"scale", wrong}};
    EXPECT_NE(folder.refusal("a.glb", moved.glb(), {}, letters).find("its texture's transform"),
              std::string::npos);
  }
}

// Names and extras say nothing about a scene, whatever they are.
TEST(Replaced, ExtrasAndNamesOfAnyKind) {
  const testing::SceneFolder folder;
  for (const nlohmann::json& any :
       {nlohmann::json(1), nlohmann::json(nullptr), nlohmann::json(true), nlohmann::json::array({1, "a"}),
        nlohmann::json("text"), nlohmann::json(1.5e300)}) {
    GltfFile file = textured();
    for (const char* place : {"", "/asset", "/scenes/0", "/nodes/0", "/meshes/0", "/meshes/0/primitives/0",
                              "/materials/0", "/textures/0", "/images/0", "/accessors/0", "/bufferViews/0"}) {
      file.json[nlohmann::json::json_pointer(place)]["extras"] = any;
      if (std::string(place) != "") {
        file.json[nlohmann::json::json_pointer(place)]["name"] = any;
      }
    }
    EXPECT_EQ(folder.refusal("a.glb", file.glb(), {}, letters), "no UserError") << any;
  }
}

TEST(Replaced, OfPly) {
  const testing::SceneFolder folder;
  const auto ply = [](const std::string& header, const std::string& property, const std::string& value) {
    std::string text = "ply\nformat ascii 1.0\n" + header +
                       "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + property +
                       "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (const char* vertex : {"0 0 0 ", "1 0 0 ", "1 1 0 ", "0 1 0 "}) {
      text += vertex + value + "\n";
    }
    return text + "4 0 1 2 3\n";
  };
  const std::string normals = "property char nx\nproperty char ny\nproperty char nz\n";
  expect_replaced(
      folder, "a.ply",
      {{ply("exported by somebody\nTextureFile a.png\n", "", ""),
        "2 lines of the header that are no statement of PLY, by none",
        "a.ply:3: 'exported' is no statement of a PLY header"},
       {ply("", "property half quality\n", "0.5"), "1 types of properties that PLY does not have",
        "'half' is no type of PLY"},
       {ply("", normals, "0.6 0 0.8"), "8 normals' coordinates that are not of their property's type",
        "'0.6' is no whole number"}});
  EXPECT_LT(
      glm::length(folder.open("a.ply", ply("", normals, "0.6 0 0.8")).normals[0] - glm::dvec3(0.6, 0, 0.8)),
      1e-15);
  FileOptions strict;
  strict.strict = true;
  const std::string colours = ply("", "property uchar red\n", "0.5");
  EXPECT_TRUE(has_note(folder.open("a.ply", colours), "1 properties of the element 'vertex': red"));
  EXPECT_NE(folder.refusal("a.ply", colours, strict).find("'0.5' is no whole number"), std::string::npos);
}

}  // namespace
}  // namespace marti::scenes
