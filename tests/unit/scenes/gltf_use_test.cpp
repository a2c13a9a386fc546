// The parts of a file that its scene uses, the parts that are not read, and images that are decoded later.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "scenes/gltf.h"
#include "scenes/open.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/scenes/gltf_file.h"

namespace marti::scenes {
namespace {

using testing::GltfFile;

Texture grey_pixels(std::span<const std::byte> file, std::string_view /*name*/) {
  if (file[0] == std::byte{'X'}) {
    throw sim::UserError("not a picture");
  }
  return texture_from_samples("", 2, 1, 1, std::vector<std::uint8_t>{1, 2});
}

ImageSize two_by_one(std::span<const std::byte> /*file*/, std::string_view /*name*/) { return {2, 1}; }

// Scene 0: a textured square with unused tangents. Scene 1: another mesh with its own material, image
// and camera.
GltfFile two_scenes() {
  GltfFile file = GltfFile::square();
  const int picture = file.add_view<std::uint8_t>({'P', 'I', 'C'});
  const int broken = file.add_view<std::uint8_t>({'X', 'X', 'X', 'X', 'X'});
  const int uvs = file.add_accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 2);
  const int tangents = file.add_accessor<float>(std::vector<float>(16, 1.0F), 5126, "VEC4", 4);
  const int other = file.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  file.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}},
                         {{"bufferView", broken}, {"mimeType", "image/png"}}};
  file.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  for (int i = 0; i < 2; ++i) {
    file.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
  }
  file.primitive()["material"] = 0;
  file.primitive()["attributes"]["TEXCOORD_0"] = uvs;
  file.primitive()["attributes"]["TANGENT"] = tangents;
  file.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", other}}}, {"material", 1}}}}});
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  file.json["nodes"].push_back({{"mesh", 1}, {"camera", 0}});
  file.json["scenes"].push_back({{"nodes", {1}}});
  return file;
}

class GltfUse : public ::testing::Test {
 protected:
  AnimatedScene open(const GltfFile& file, const FileOptions& options) {
    return open_gltf(file.write_glb(directory_.path(), "scene.glb"), options, grey_pixels);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(GltfUse, CountsWhatTheSceneDoesNotUse) {
  const FileUse use = open(two_scenes(), {}).file_use();
  std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> parts;
  for (const PartUse& part : use.parts) {
    parts[std::string(part.name)] = {part.used, part.all};
  }
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  for (const char* halved : {"scenes", "nodes", "meshes", "materials", "images"}) {
    EXPECT_EQ(parts[halved], Pair(1, 2)) << halved;
  }
  EXPECT_EQ(parts["cameras"], Pair(0, 1));
  EXPECT_EQ(parts["skins"], Pair(0, 0));
  EXPECT_EQ(parts["accessors"], Pair(3, 5));
  // Four tangents, three positions, one image.
  EXPECT_EQ(use.unread_bytes, 64U + 36U + 5U);
  FileOptions other;
  other.scene = "1";
  other.strict = true;
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(open(two_scenes(), other)); }).find("not a picture"),
            std::string::npos);
  EXPECT_TRUE(AnimatedScene(Scene{}).file_use().parts.empty());
}

// With the item kept, unused parts are read and checked.
TEST_F(GltfUse, ReadsWhatNobodyUsesWhenAsked) {
  FileOptions all;
  all.read_unused = true;
  GltfFile file = two_scenes();
  all.strict = true;
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(open(file, all)); }).find("not a picture"),
            std::string::npos);
  all.strict = false;
  EXPECT_NE(describe(open(file, all).at(0.0)).find("Replaced: 1 textures"), std::string::npos);
  file.json["images"][1]["bufferView"] = file.json["images"][0]["bufferView"];
  const FileUse use = open(file, all).file_use();
  EXPECT_EQ(use.unread_bytes, 64U + 36U + 3U) << "what nobody uses, whether it is read or not";
  file.json["accessors"][3]["count"] = 5;  // more tangents than there are
  EXPECT_EQ(open(file, {}).file_use().unread_bytes, 80U + 36U + 3U);
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(open(file, all)); }).find("accessor 3"),
            std::string::npos);
  // With no count does the sum exceed the file.
  file.json["accessors"][3]["count"] = std::uint64_t{1} << 60U;
  EXPECT_LE(open(file, {}).file_use().unread_bytes, file.bin.size() + 36U + 3U + 3U);
}

TEST_F(GltfUse, ImagesWaitForTheirDecoding) {
  FileOptions waiting;
  waiting.size_only = two_by_one;
  const GltfFile file = two_scenes();
  const Scene whole = open(file, {}).at(0.0);
  Scene scene = open(file, waiting).at(0.0);
  ASSERT_EQ(scene.textures.size(), 1U);
  Texture& texture = scene.textures[0];
  EXPECT_TRUE(texture.texels.empty());
  EXPECT_EQ(texture.size(), whole.textures[0].size());
  EXPECT_EQ(texture.repeat_u, whole.textures[0].repeat_u);
  EXPECT_EQ(sample_nearest(texture, {0.7, 0.5}).texel, sample_nearest(whole.textures[0], {0.7, 0.5}).texel);
  EXPECT_EQ(sample_nearest(texture, {0.7, 0.5}).color, glm::dvec3(1.0));
  const Scene copy = scene;
  decode_texels(texture, grey_pixels);
  EXPECT_EQ(texture.texels, whole.textures[0].texels);
  EXPECT_EQ(texture.file, nullptr);
  EXPECT_TRUE(copy.textures[0].texels.empty());

  // An image that turns out to have another size than its head says.
  waiting.size_only = [](std::span<const std::byte>, std::string_view) { return ImageSize{4, 4}; };
  scene = open(file, waiting).at(0.0);
  EXPECT_NE(test::user_error_of([&] { decode_texels(scene.textures[0], grey_pixels); }).find("4 x 4"),
            std::string::npos);
  // One whose head is broken is refused when the file is read.
  waiting.size_only = [](std::span<const std::byte>, std::string_view) -> ImageSize {
    throw sim::UserError("no head");
  };
  waiting.strict = true;
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(open(file, waiting)); }).find("no head"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::scenes
