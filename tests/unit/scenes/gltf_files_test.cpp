// Which other files a file may read, compressed files of other programs, and how much memory a file may take.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "scenes/gltf.h"
#include "scenes/open.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/scenes/gltf_file.h"
#include "tests/unit/scenes/loaded_scene.h"

namespace marti::scenes {
namespace {

using test::says;
using testing::GltfFile;
using testing::load_gltf;

std::string refusal(const std::filesystem::path& path, const FileOptions& options = {},
                    const ImageDecoder& decode = {}) {
  return test::user_error_of([&] { static_cast<void>(load_gltf(path, options, decode)); });
}

// A scene in a folder, and its buffer where the test wants it.
class GltfFolder : public ::testing::Test {
 protected:
  GltfFolder() {
    std::filesystem::create_directories(folder() / "inside");
    testing::write_bytes(outer_.path() / "outside.bin", square_.bin);
    testing::write_bytes(folder() / "inside" / "data.bin", square_.bin);
  }
  [[nodiscard]] std::filesystem::path folder() const { return outer_.path() / "scene"; }
  // Loads the square with its buffer at this URI.
  [[nodiscard]] std::string load(const std::string& uri) const {
    GltfFile file = square_;
    file.json["buffers"] = {{{"byteLength", file.bin.size()}, {"uri", uri}}};
    return refusal(file.write_gltf(folder(), "scene.gltf"));
  }

  test::TemporaryDirectory outer_;
  GltfFile square_ = GltfFile::square();
};

TEST_F(GltfFolder, FilesInsideAreRead) {
  std::filesystem::create_symlink("inside/data.bin", folder() / "link.bin");
  std::filesystem::create_directory_symlink("inside", folder() / "linked");
  for (const char* uri : {"inside/data.bin", "inside/../inside/data.bin", "inside%2Fdata.bin", "link.bin",
                          "linked/data.bin", "../scene/inside/data.bin"}) {
    EXPECT_EQ(load(uri), "no UserError") << uri;
  }
}

TEST_F(GltfFolder, NothingOutsideIsRead) {
  std::filesystem::create_symlink(outer_.path() / "outside.bin", folder() / "link.bin");
  std::filesystem::create_directory_symlink("..", folder() / "up");
  const std::string absolute = (outer_.path() / "outside.bin").string();
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("%2e%2e/outside.bin"), std::string("..%2foutside.bin"),
        std::string("inside/../../outside.bin"), std::string("link.bin"), std::string("up/outside.bin"),
        absolute, "file:" + absolute, "file://" + absolute, std::string("https://host/outside.bin"),
        std::string("../no such file")}) {
    const std::string message = load(uri);
    EXPECT_TRUE(says(message, "leads out of the scene's folder")) << uri << ": " << message;
    EXPECT_EQ(message.rfind((folder() / "scene.gltf").string() + ": the URI \"", 0), 0U) << message;
  }
}

TEST_F(GltfFolder, ForeignTextIsEscapedAndCut) {
  const std::string message = load("../\x1b[31m\n" + std::string(3000, 'x'));
  EXPECT_TRUE(says(message, "\\u001b[31m\\n")) << message;
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_LT(message.size(), 500U);
}

TEST_F(GltfFolder, FilesBeyondTheMemoryAreNotRead) {
  testing::write_bytes(folder() / "large.bin", square_.bin);
  std::filesystem::resize_file(folder() / "large.bin", std::uintmax_t{1} << 36U);  // no block of it is there
  GltfFile file = square_;
  file.json["buffers"] = {{{"byteLength", std::uint64_t{1} << 31U}, {"uri", "sparse.bin"}}};
  testing::write_bytes(folder() / "sparse.bin", "");
  std::filesystem::resize_file(folder() / "sparse.bin", std::uintmax_t{1} << 31U);
  FileOptions options;
  options.memory = sim::MemoryBudget(std::uint64_t{1} << 20U);
  const std::string message = refusal(file.write_gltf(folder(), "scene.gltf"), options);
  EXPECT_TRUE(says(message, "sparse.bin")) << message;
  EXPECT_TRUE(says(message, "4 GiB")) << message;
  EXPECT_TRUE(says(message, "more than 1 MiB")) << message;
}

TEST(GltfCompressed, IsReadWhereItsDataAreThereUncompressed) {
  const std::filesystem::path files = MARTI_COMPRESSED_SCENES;
  const Scene quantized = load_gltf(files / "quantized.glb", {}, {});
  const Scene fallback = load_gltf(files / "meshopt_fallback.glb", {}, {});
  EXPECT_EQ(quantized.triangles.size(), 128U);
  EXPECT_EQ(fallback.triangles.size(), 128U);
  const Bounds a = bounds_of(quantized);
  const Bounds b = bounds_of(fallback);
  EXPECT_EQ(a.hi, b.hi);
  EXPECT_NEAR(a.hi.x, 1.0, 1e-4);
  EXPECT_NEAR(a.hi.z, 0.0625, 1e-4);
}

// A sparse accessor puts right indices that are all zeros, or some that are wrong.
TEST(GltfSparse, IndicesAreReplaced) {
  const test::TemporaryDirectory directory;
  const Scene plain = load_gltf(GltfFile::square().write_glb(directory.path(), "plain.glb"), {}, {});
  for (const bool based : {true, false}) {
    GltfFile file = GltfFile::square();
    const std::vector<std::uint16_t> wrong = {0, 3, 3, 0, 2, 3};
    const std::vector<std::uint8_t> where =
        based ? std::vector<std::uint8_t>{1, 2} : std::vector<std::uint8_t>{1, 2, 4, 5};
    const std::vector<std::uint16_t> what =
        based ? std::vector<std::uint16_t>{1, 2} : std::vector<std::uint16_t>{1, 2, 2, 3};
    const int base = file.add_view(wrong);
    const int places = file.add_view(where);
    const int values = file.add_view(what);
    nlohmann::json& accessor = file.json["accessors"][1];
    accessor.erase("bufferView");
    if (based) {
      accessor["bufferView"] = base;
    }
    accessor["sparse"] = {{"count", where.size()},
                          {"indices", {{"bufferView", places}, {"componentType", 5121}}},
                          {"values", {{"bufferView", values}}}};
    const Scene scene = load_gltf(file.write_glb(directory.path(), "sparse.glb"), {}, {});
    ASSERT_EQ(scene.triangles.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(scene.triangles[i].vertex, plain.triangles[i].vertex);
    }
  }
}

// `count` materials, textures and images, all with equal bytes except the last.
GltfFile pictures(int count) {
  GltfFile file = GltfFile::square();
  const int shared = file.add_view<std::uint8_t>({'P', 'I', 'C'});
  const int copy = file.add_view<std::uint8_t>({'P', 'I', 'C'});
  const int other = file.add_view<std::uint8_t>({'P', 'I', 'X'});
  const int uvs = file.add_accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 2);
  file.primitive()["attributes"]["TEXCOORD_0"] = uvs;
  const nlohmann::json primitive = file.primitive();
  for (int i = 0; i < count; ++i) {
    const int view = i + 1 == count ? other : i % 2 == 0 ? shared : copy;
    file.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
    file.json["textures"].push_back({{"source", i}});
    file.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    file.json["meshes"][0]["primitives"][static_cast<std::size_t>(i)] = primitive;
    file.primitive(static_cast<std::size_t>(i))["material"] = i;
  }
  return file;
}

TEST(GltfImages, EqualOnesAreDecodedOnce) {
  const test::TemporaryDirectory directory;
  int decoded = 0;
  const ImageDecoder decode = [&](std::span<const std::byte> file, std::string_view /*name*/) {
    ++decoded;
    return texture_from_samples("", 1, 1, 1, std::vector<std::uint8_t>{static_cast<std::uint8_t>(file[2])});
  };
  const Scene scene = load_gltf(pictures(200).write_glb(directory.path(), "a.glb"), {}, decode);
  EXPECT_EQ(decoded, 2);
  ASSERT_EQ(scene.textures.size(), 2U);
  ASSERT_EQ(scene.materials.size(), 200U);
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_EQ(scene.textures[scene.materials[i].texture].texels[0][0], i == 199 ? 'X' : 'C') << i;
  }
}

TEST(GltfImages, TexelsAreCountedBeforeTheyAreDecoded) {
  const test::TemporaryDirectory directory;
  const ImageDecoder never = [](std::span<const std::byte> /*file*/, std::string_view /*name*/) -> Texture {
    ADD_FAILURE() << "an image that is too large is decoded";
    return {};
  };
  FileOptions options;
  options.size_first = [](std::span<const std::byte> /*file*/, std::string_view /*name*/) {
    return ImageSize{16384, 16384};
  };
  options.memory = sim::MemoryBudget(std::uint64_t{1} << 30U);
  const std::string message = refusal(pictures(3).write_glb(directory.path(), "a.glb"), options, never);
  EXPECT_TRUE(says(message, "textures take about 2 GiB")) << message;
  EXPECT_TRUE(says(message, "more than 1 GiB")) << message;
}

// One mesh of many triangles in many nodes: refused by its count at every limit below the memory that it
// takes, and read at every limit above.
TEST(GltfInstances, AreCountedBeforeTheyAreExpanded) {
  const test::TemporaryDirectory directory;
  GltfFile file = GltfFile::square();
  constexpr int nodes = 20'000;
  file.json["nodes"].clear();
  file.json["scenes"][0]["nodes"].clear();
  for (int i = 0; i < nodes; ++i) {
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"].push_back(i);
  }
  const auto path = file.write_glb(directory.path(), "many.glb");
  const Scene scene = load_gltf(path, {}, {});
  EXPECT_EQ(scene.triangles.size(), 2U * nodes);
  const std::uint64_t takes = host_bytes(scene);
  EXPECT_GT(takes, 2U * nodes * sizeof(Triangle));
  FileOptions options;
  options.memory = sim::MemoryBudget(takes);
  EXPECT_TRUE(says(refusal(path, options), "memory_limit")) << "its JSON takes more";
  options.memory = sim::MemoryBudget(20 * takes);
  EXPECT_EQ(refusal(path, options), "no UserError");
}

// Files of a few kilobytes whose vertices have no bytes in the file: normals of their own for each primitive,
// and many morph targets.
TEST(GltfInstances, VerticesThatSmallFilesDeclareAreCounted) {
  constexpr int count = 30'000;
  constexpr int times = 100;
  const test::TemporaryDirectory directory;
  const auto declared = [&](GltfFile& file) {
    file.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", count}});
    return static_cast<int>(file.json["accessors"].size() - 1);
  };
  GltfFile normals = GltfFile::square();
  GltfFile targets = GltfFile::square();
  for (GltfFile* const file : {&normals, &targets}) {
    const int positions = declared(*file);
    file->primitive()["attributes"] = {{"POSITION", positions}, {"NORMAL", declared(*file)}};
  }
  for (int i = 0; i < times; ++i) {
    nlohmann::json primitive = normals.primitive();
    primitive["attributes"]["NORMAL"] = declared(normals);
    normals.json["meshes"][0]["primitives"].push_back(primitive);
    targets.primitive()["targets"].push_back(
        {{"POSITION", declared(targets)}, {"NORMAL", declared(targets)}});
  }
  FileOptions options;
  options.memory = sim::MemoryBudget(std::uint64_t{64} << 20U);
  for (const GltfFile* const file : {&normals, &targets}) {
    const std::string message = refusal(file->write_glb(directory.path(), "a.glb"), options);
    EXPECT_TRUE(says(message, "its instances take about")) << message;
  }
}

}  // namespace
}  // namespace marti::scenes
