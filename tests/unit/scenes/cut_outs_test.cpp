// What files say of holes in their triangles: alphaMode of glTF, map_d of OBJ, alpha of pbrt.
#include <array>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "scenes/gltf_export.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::GltfFile;
using testing::has_note;

/// Every image is of two texels: grey 200 of alpha 255, and grey 100 of alpha 51.
Texture two_texels(std::span<const std::byte> /*bytes*/, std::string_view name) {
  return texture_from_samples(name, 2, 1, 2, std::array<std::uint8_t, 4>{200, 255, 100, 51});
}

TEST(CutOuts, TexelsHaveAnAlphaOfOneKindOrTheOther) {
  Texture texture = two_texels({}, "a");
  EXPECT_EQ(alpha_of(texture, 0), 1.0);
  EXPECT_EQ(alpha_of(texture, 1), 0.2);
  texture.grey_is_alpha = true;
  EXPECT_DOUBLE_EQ(alpha_of(texture, 1), 100.0 / 255.0);
  texture.texels.clear();
  EXPECT_EQ(alpha_of(texture, 1), 1.0) << "not decoded";
}

class GltfCutOuts : public ::testing::Test {
 protected:
  /// A square of two triangles whose material has a texture, with coordinates for it or not.
  static GltfFile file(const nlohmann::json& material, bool textured = true, bool coordinates = true) {
    GltfFile file = GltfFile::square();
    const int image = file.add_view<std::uint8_t>({'P'});
    const int uvs = file.add_accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 2);
    file.json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}}};
    file.json["textures"] = {{{"source", 0}}};
    file.json["materials"] = {material};
    if (textured) {
      file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    }
    file.primitive()["material"] = 0;
    if (coordinates) {
      file.primitive()["attributes"]["TEXCOORD_0"] = uvs;
    }
    return file;
  }
  Scene load(const GltfFile& made, bool strict = false) const {
    OpenOptions options;
    options.base_directory = directory_.path();
    options.file.strict = strict;
    static_cast<void>(made.write_glb(directory_.path(), "a.glb"));
    return open_scene("a.glb", options, two_texels);
  }
  std::string refusal(const GltfFile& made) const {
    return test::user_error_of([&] { static_cast<void>(load(made, true)); });
  }
  test::TemporaryDirectory directory_;
};

TEST_F(GltfCutOuts, TheCutOffIsTheFilesOrAHalf) {
  const CutOut opaque = load(file({{"alphaMode", "OPAQUE"}})).materials[0].cut_out;
  EXPECT_FALSE(opaque.asks());
  const CutOut by_default = load(file({{"alphaMode", "MASK"}})).materials[0].cut_out;
  EXPECT_TRUE(by_default.asks());
  EXPECT_EQ(by_default.texture, 0U);
  EXPECT_EQ(by_default.cutoff, 0.5);
  EXPECT_TRUE(by_default.keeps(0.5));
  EXPECT_FALSE(by_default.keeps(0.49));
  const Scene masked = load(file({{"alphaMode", "MASK"},
                                  {"alphaCutoff", 0.1},
                                  {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}}));
  EXPECT_EQ(masked.materials[0].cut_out.alpha, 0.5);
  EXPECT_EQ(masked.materials[0].cut_out.cutoff, 0.1);
  const Scene blended = load(file({{"alphaMode", "BLEND"}}));
  EXPECT_EQ(blended.materials[0].cut_out.cutoff, cutoff_of_blending);
  EXPECT_TRUE(has_note(blended, "1 materials' blending"));
  EXPECT_FALSE(load(file({{"alphaMode", "MASK"}, {"alphaCutoff", 0.0}})).materials[0].cut_out.asks());
}

TEST_F(GltfCutOuts, WithoutATextureAllIsCutOutOrNothing) {
  const auto of_alpha = [](double alpha) {
    return file({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}},
                false);
  };
  EXPECT_FALSE(load(of_alpha(0.5)).materials[0].cut_out.asks());
  EXPECT_NE(refusal(of_alpha(0.49)), "") << "nothing is left of the scene";
  GltfFile more = of_alpha(0.49);
  more.json["meshes"][0]["primitives"].push_back(more.primitive());
  more.primitive(1).erase("material");
  const Scene scene = load(more);
  EXPECT_EQ(scene.triangles.size(), 2U);
  EXPECT_TRUE(has_note(scene, "1 primitives that are cut out as a whole"));
}

TEST_F(GltfCutOuts, FaultsAreReplacedOrRefused) {
  const GltfFile bare = file({{"alphaMode", "MASK"}}, true, false);
  EXPECT_TRUE(has_note(load(bare), "1 texture coordinates of cut-outs that are not given, by (0, 0)"));
  EXPECT_NE(refusal(bare).find("a.glb: mesh 0, primitive 0: its material is cut out"), std::string::npos);
  const GltfFile odd = file({{"alphaMode", "HOLES"}});
  const Scene scene = load(odd);
  EXPECT_TRUE(has_note(scene, "1 alpha modes that glTF does not have, by OPAQUE"));
  EXPECT_FALSE(scene.materials[0].cut_out.asks());
  EXPECT_NE(refusal(odd).find("there is no alpha mode 'HOLES'"), std::string::npos) << refusal(odd);
  for (const double cutoff : {-0.1, 1e300}) {
    EXPECT_NE(refusal(file({{"alphaMode", "MASK"}, {"alphaCutoff", cutoff}})).find("the alpha cut-off"),
              std::string::npos);
  }
}

TEST(ObjCutOuts, AreThoseOfMapD) {
  const testing::SceneFolder folder;
  folder.write("a.png", "A");
  folder.write("b.png", "B");
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n";
  const auto open = [&](const std::string& material, const std::string& face,
                        const FileOptions& options = {}) {
    folder.write("m.mtl", "newmtl a\n" + material);
    return folder.open("a.obj", "mtllib m.mtl\n" + square + "f 1 2 3\nusemtl a\n" + face, options,
                       two_texels);
  };
  const std::string face = "f 1/1 2/1 3/1 4/1\n";
  const auto cut_out = [&](const std::string& material) {
    const Scene scene = open(material, face);
    EXPECT_EQ(scene.uvs.size(), scene.positions.size());
    EXPECT_EQ(scene.materials[1].diffuse, 1.0);
    EXPECT_EQ(scene.materials[1].transmission, 0.0);
    EXPECT_TRUE(scene.materials[1].cut_out.asks());
    return std::pair(scene.materials[1].cut_out, scene.textures[scene.materials[1].cut_out.texture]);
  };
  const auto [grey, image] = cut_out("map_d a.png\n");
  EXPECT_TRUE(image.grey_is_alpha);
  EXPECT_EQ(grey.alpha, 1.0);
  EXPECT_EQ(grey.cutoff, 0.5);
  EXPECT_FALSE(cut_out("map_d -imfchan m -clamp on a.png\n").second.grey_is_alpha);
  EXPECT_FALSE(cut_out("map_Kd a.png\nmap_d a.png\n").second.grey_is_alpha)
      << "the alpha of the colours' file";
  EXPECT_EQ(open("map_Kd a.png\nmap_d a.png\n", face).textures.size(), 1U);
  EXPECT_EQ(open("map_Kd b.png\nmap_d a.png\n", face).textures.size(), 2U);
  EXPECT_EQ(cut_out("d 0.75\nmap_d a.png\n").first.alpha, 0.75);

  // Without an image d is transparency, as before.
  EXPECT_EQ(open("d 0.25\n", face).materials[1].transmission, 0.75);
  EXPECT_EQ(open("d 0.25\nmap_d none.png\n", face).materials[1].transmission, 0.75);
  const Scene gone = open("d 0.25\nmap_d a.png\n", face);
  EXPECT_EQ(gone.triangles.size(), 1U);
  EXPECT_TRUE(has_note(gone, "1 faces that are cut out as a whole"));
}

TEST(ObjCutOuts, FaultsAreReplacedOrRefusedWithFileAndLine) {
  const testing::SceneFolder folder;
  folder.write("a.png", "A");
  const std::string text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n";
  FileOptions strict;
  strict.strict = true;
  const auto expect = [&](const std::string& material, const std::string& note, const std::string& refusal) {
    folder.write("m.mtl", "newmtl a\n" + material);
    EXPECT_TRUE(has_note(folder.open("a.obj", text, {}, two_texels), note));
    const std::string got = folder.refusal("a.obj", text, strict, two_texels);
    EXPECT_NE(got.find(refusal), std::string::npos) << got;
  };
  expect("map_d a.png\n", "1 texture coordinates of cut-outs that are not given, by (0, 0)",
         "a.obj:6: a face whose material has map_d needs texture coordinates");
  expect("map_d none.png\n", "1 textures that cannot be read, by none", "m.mtl:2: 'none.png' cannot be read");
  expect("map_d -clamp on\n", "1 textures without a file's name, by none", "m.mtl:2: map_d needs the name");
  folder.write("m.mtl", "newmtl a\nmap_d -holes a.png\n");
  EXPECT_NE(folder.refusal("a.obj", text, {}, two_texels).find("m.mtl:2: map_d has no option '-holes'"),
            std::string::npos);
}

TEST(PbrtCutOuts, AreThoseOfTheShapesAlpha) {
  const testing::SceneFolder folder;
  folder.write("a.png", "A");
  const auto open = [&](const std::string& alpha, const std::string& uv = "\"point2 uv\" [ 0 0 1 0 0 1 ]") {
    return folder.open("a.pbrt",
                       "WorldBegin\nTexture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.png\"\n"
                       "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n"
                       "Texture \"s\" \"float\" \"scale\" \"texture tex\" \"t\" \"float scale\" .75\n"
                       "Material \"diffuse\" \"texture reflectance\" \"c\"\n"
                       "Shape \"sphere\" Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] " +
                           uv + alpha,
                       {}, two_texels);
  };
  EXPECT_EQ(open("").materials.size(), 1U);
  const Scene scene = open("\"texture alpha\" \"t\"");
  ASSERT_EQ(scene.materials.size(), 2U);
  EXPECT_FALSE(scene.materials[0].cut_out.asks());
  const Material& leaf = scene.materials[1];
  EXPECT_TRUE(leaf.cut_out.asks());
  EXPECT_EQ(leaf.cut_out.alpha, 1.0);
  EXPECT_EQ(leaf.cut_out.cutoff, 0.5);
  EXPECT_TRUE(scene.textures[leaf.cut_out.texture].grey_is_alpha);
  EXPECT_FALSE(scene.textures[leaf.texture].grey_is_alpha);  // the file is read once more for its colours
  EXPECT_EQ(open("\"texture alpha\" \"s\"").materials[1].cut_out.alpha, 0.75);

  // Numbers say that all of a shape is there, or nothing of it.
  EXPECT_EQ(open("\"float alpha\" .5").materials.size(), 1U);
  const Scene gone = open("\"float alpha\" 0");
  EXPECT_TRUE(gone.triangles.empty());
  EXPECT_TRUE(has_note(gone, "1 shapes that are cut out as a whole"));
  // A mesh without coordinates has pbrt's; round shapes have none here.
  const Scene bare = open("\"texture alpha\" \"t\"", "");
  EXPECT_TRUE(bare.materials[bare.triangles[0].material].cut_out.asks());
  const Scene round = open("Shape \"sphere\" \"texture alpha\" \"t\"", "");
  EXPECT_TRUE(has_note(round, "1 cut-outs of shapes without texture coordinates"));
  EXPECT_FALSE(round.materials[round.quadrics[1].material].cut_out.asks());
}

}  // namespace
}  // namespace marti::scenes
