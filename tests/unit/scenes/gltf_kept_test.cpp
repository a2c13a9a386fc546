// Meshes that nodes of a glTF file share, kept once: what is kept, and that it is what copies are.
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/scenes/loaded_scene.h"

namespace marti::scenes::testing {
namespace {

/// Three nodes share the square, one mirrored and one below another; a fourth has a mesh of its own.
GltfFile shared_square() {
  GltfFile file = GltfFile::square();
  file.json["meshes"].push_back(file.json["meshes"][0]);
  file.json["nodes"] = {{{"mesh", 0}, {"translation", {1, 2, 3}}, {"children", {1}}},
                        {{"mesh", 0}, {"rotation", {0.6, 0, 0, 0.8}}, {"scale", {2, 1, 0.5}}},
                        {{"mesh", 0}, {"scale", {-1, 1, 1}}},
                        {{"mesh", 1}, {"translation", {5, 0, 0}}}};
  file.json["scenes"] = {{{"nodes", {0, 2, 3}}}};
  return file;
}

class KeptMeshesOfGltf : public ::testing::Test {
 protected:
  [[nodiscard]] AnimatedScene open(const GltfFile& file, Instances instances) const {
    FileOptions options;
    options.instances = instances;
    return open_gltf(file.write_glb(directory_.path(), "scene.glb"), options, {});
  }
  [[nodiscard]] Scene load(const GltfFile& file, Instances instances) const {
    return open(file, instances).at(0.0);
  }

 private:
  marti::test::TemporaryDirectory directory_;
};

TEST_F(KeptMeshesOfGltf, AreWhatCopiesAre) {
  const Scene kept = load(shared_square(), Instances::kept);
  ASSERT_EQ(kept.instances.size(), 4U);  // the mesh of one node is the first, with all that is copied
  ASSERT_EQ(kept.meshes.size(), 2U);
  EXPECT_EQ(kept.triangles.size(), 4U);
  EXPECT_EQ(kept.instances[0].mesh, 0U);
  EXPECT_TRUE(kept.instances[0].linear == glm::dmat3(1.0));
  EXPECT_TRUE(has_note(kept, "4 of 2 meshes stand for 8 triangles"));
  const Scene copied = load(shared_square(), Instances::copied);
  EXPECT_TRUE(copied.instances.empty());
  EXPECT_EQ(sorted_triangles(copied_instances(kept)), sorted_triangles(copied));
  const Bounds box = bounds_of(kept);
  const Bounds box_of_copies = bounds_of(copied);
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(box.lo[a], box_of_copies.lo[a], 1e-12);
    EXPECT_NEAR(box.hi[a], box_of_copies.hi[a], 1e-12);
  }
}

TEST_F(KeptMeshesOfGltf, AutoCopiesSmallScenes) {
  EXPECT_TRUE(load(shared_square(), Instances::automatic).instances.empty());
}

TEST_F(KeptMeshesOfGltf, MeshesThatShineAreCopied) {
  GltfFile file = shared_square();
  file.json["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
  file.primitive()["material"] = 0;
  EXPECT_TRUE(load(file, Instances::kept).instances.empty());
}

TEST_F(KeptMeshesOfGltf, PlacesThatCannotBeTurnedBackAreCopied) {
  GltfFile file = shared_square();
  file.json["nodes"][1]["scale"] = {1, 1, 0};
  const Scene scene = load(file, Instances::kept);
  EXPECT_EQ(scene.instances.size(), 3U);
  EXPECT_EQ(scene.meshes[0].count, 4U);  // the flat one and that of one node
}

TEST_F(KeptMeshesOfGltf, MoveWithTheirNodes) {
  const auto moving = [](const char* path, const std::vector<float>& values) {
    GltfFile file = shared_square();
    file.json["animations"] = {{{"samplers",
                                 {{{"input", file.add_accessor<float>({0, 1}, 5126, "SCALAR", 1)},
                                   {"output", file.add_positions(values)}}}},
                                {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
    return file;
  };
  const GltfFile file = moving("translation", {1, 2, 3, 9, 2, 3});
  const AnimatedScene kept = open(file, Instances::kept);
  const AnimatedScene copied = open(file, Instances::copied);
  for (const double time : {0.0, 0.3, 1.0}) {
    const Scene scene = kept.at(time);
    ASSERT_EQ(scene.instances.size(), 4U);
    EXPECT_EQ(sorted_triangles(copied_instances(scene)), sorted_triangles(copied.at(time))) << time;
  }
  EXPECT_NE(sorted_triangles(copied.at(0.0)), sorted_triangles(copied.at(1.0)));
  const AnimatedScene shrinks = open(moving("scale", {1, 1, 1, 1, 0, 1}), Instances::kept);
  EXPECT_EQ(shrinks.at(0.5).instances.size(), 4U);
  EXPECT_TRUE(test::says(test::user_error_of([&] { static_cast<void>(shrinks.at(1.0)); }),
                         "node 0 cannot be kept in this pose: its transform is singular"));
}

TEST_F(KeptMeshesOfGltf, EachPrimitiveIsOfTheInstanceThatItsNumberIsIn) {
  const Scene scene = load(shared_square(), Instances::kept);
  for (std::uint32_t id = 0; id < 8; ++id) {
    const HitTriangle hit = hit_triangle(scene, id);
    EXPECT_EQ(hit.place, &scene.instances[id / 2]);
    EXPECT_EQ(hit.triangle, scene.meshes[hit.place->mesh].first + id % 2);
  }
}

}  // namespace
}  // namespace marti::scenes::testing
