// One mesh in every format gives the same triangles, camera and light, and so the same image.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "loaded_scene.h"
#include "random_mesh.h"
#include "scenes/procedural.h"
#include "sim/work_meter.h"
#include "tests/unit/processors/program_scenes.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::corner;
using testing::PlyOrder;
using testing::RandomMesh;
using testing::SceneFolder;

void expect_same_triangles(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  EXPECT_EQ(a.polygons, b.polygons);
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(corner(a, t, i), corner(b, t, i)) << t;
    }
  }
}

void expect_same_image(const processors::test::Built& a, const Scene& b) {
  const processors::program::RenderOptions options{.width = 40, .height = 40, .max_depth = 2};
  const processors::program::Frame expected = a.render(options);
  const processors::program::Frame frame = processors::test::Built(b, "octree").render(options);
  EXPECT_EQ(frame.hit_hash, expected.hit_hash);
  EXPECT_EQ(frame.image.pixels, expected.image.pixels);
  const auto lit = std::count_if(frame.image.pixels.begin(), frame.image.pixels.end(),
                                 [](const auto& pixel) { return pixel != decltype(pixel){}; });
  EXPECT_GT(lit, 100);
}

// What the mesh itself says, without a reader.
void expect_triangles_of(const RandomMesh& mesh, const Scene& scene) {
  ASSERT_EQ(scene.triangles.size(), mesh.triangles());
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const float* const p = mesh.positions.data() + 3 * std::size_t{mesh.indices[3 * t + i]};
      ASSERT_EQ(corner(scene, t, i), glm::dvec3(p[0], p[1], p[2]));
    }
  }
}

TEST(Formats, TextAndBinaryGiveTheTrianglesAndTheImageOfGltf) {
  const SceneFolder folder;
  for (const std::uint32_t seed : {1U, 2U}) {
    const RandomMesh mesh(seed, 6);
    const Scene gltf = folder.open("mesh.glb", mesh.gltf().glb());
    expect_triangles_of(mesh, gltf);
    const processors::test::Built built(gltf, "octree");
    const std::vector<std::pair<std::string, std::string>> files = {
        {"mesh.obj", mesh.obj()},
        {"text.ply", mesh.ply(PlyOrder::text)},
        {"little.ply", mesh.ply(PlyOrder::little)},
        {"big.ply", mesh.ply(PlyOrder::big)}};
    for (const auto& [name, bytes] : files) {
      SCOPED_TRACE(name);
      const Scene scene = folder.open(name, bytes);
      expect_same_triangles(gltf, scene);
      expect_same_image(built, scene);
    }
  }
}

// A scene that nobody waits for any more is not read.
TEST(Formats, AskWhetherSomebodyWaits) {
  const SceneFolder folder;
  const RandomMesh mesh(1, 6);
  sim::WorkMeter meter;
  FileOptions options;
  options.memory.wait_with(&meter);
  const auto open_all = [&](bool stops) {
    for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"mesh.obj", mesh.obj()},
                                      {"little.ply", mesh.ply(PlyOrder::little)},
                                      {"mesh.glb", mesh.gltf().glb()}}) {
      if (stops) {
        EXPECT_THROW((void)folder.open(name, bytes, options), sim::Stopped) << name;
      } else {
        EXPECT_NO_THROW((void)folder.open(name, bytes, options)) << name;
      }
    }
  };
  open_all(false);
  meter.stop();
  open_all(true);
  EXPECT_THROW((void)make_procedural("tetra:3", options.memory), sim::Stopped);
}

}  // namespace
}  // namespace marti::scenes
