// Counts published for the Standard Procedural Databases, reproduced.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "accel/octree.h"
#include "scenes/procedural.h"

namespace marti::tests {
namespace {

using accel::Octree;
using accel::OctreeOptions;
using accel::TriangleSet;

std::shared_ptr<const TriangleSet> triangles_of(std::string_view scene) {
  return std::make_shared<const TriangleSet>(scenes::make_procedural(scene));
}

std::uint64_t nodes_of(const Octree& octree) { return octree.topology().nodes.size(); }

/// Percentage of the nodes in levels 8 and deeper.
double deep_share(const Octree& octree) {
  std::uint64_t deep = 0;
  for (std::size_t level = 8; level <= octree.levels().size(); ++level) {
    deep += octree.levels()[level - 1].nodes();
  }
  return 100.0 * static_cast<double>(deep) / static_cast<double>(nodes_of(octree));
}

// The pot of 9,120 triangles, at most 9 in a leaf, 12 levels, tight root: exact clipping gives 27,177 nodes,
// 42.0 % of them in levels 8 to 12. We get 27,137 and 41.9 %. The difference is how corners that lie exactly
// in a dyadic plane of the tight box are counted: with the tight box itself and a closed test without any
// margin all of them are listed on both sides (27,449 nodes, 42.1 %); with an open test those that
// merely touch are not (23,937, 39.9 %). Our root is enlarged by a margin of its own, which leaves only
// the central planes in place. There corners touch exactly, and the margin of the cells changes nothing
// (27,137 with and without it).
TEST(Structures, TeapotOctreeHasTheSizeOfExactClipping) {
  const auto pot = triangles_of("teapot:12:pot");
  ASSERT_EQ(pot->size(), 9120U);
  const Octree octree = Octree::build(pot, OctreeOptions{9, 12});
  EXPECT_NEAR(static_cast<double>(nodes_of(octree)), 27177.0, 0.01 * 27177.0);
  EXPECT_NEAR(deep_share(octree), 42.0, 0.5);
  EXPECT_EQ(octree.levels().size(), 12U);
  // "More than three times as many leaves as branches" first on level 6, ten times first on level 8.
  const auto ratio = [&](std::size_t level) {
    return static_cast<double>(octree.levels()[level - 1].leaves) /
           static_cast<double>(octree.levels()[level - 1].branches);
  };
  EXPECT_LE(ratio(5), 3.0);
  EXPECT_GT(ratio(6), 3.0);
  EXPECT_LE(ratio(7), 10.0);
  EXPECT_GT(ratio(8), 10.0);
  RecordProperty("nodes", std::to_string(nodes_of(octree)));
  RecordProperty("deep_percent", std::to_string(deep_share(octree)));
}

// Havran's counts of eye rays that hit, 513 x 513 rays through the pixel corners.
struct EyeRays {
  const char* scene;
  std::uint64_t hits;
};
void PrintTo(const EyeRays& rays, std::ostream* out) { *out << rays.scene; }
class EyeRayHits : public ::testing::TestWithParam<EyeRays> {};

std::uint64_t eye_ray_hits(const scenes::Scene& scene) {
  const Octree octree = Octree::build(std::make_shared<const TriangleSet>(scene));
  const scenes::ImagePlane plane = scene.camera.image_plane(512, 512);
  accel::NullVisitor visitor;
  std::uint64_t hits = 0;
  for (std::uint32_t y = 0; y <= 512; ++y) {
    for (std::uint32_t x = 0; x <= 512; ++x) {
      const accel::Ray ray{plane.origin, plane.corner + static_cast<double>(x) * plane.step_x +
                                             static_cast<double>(y) * plane.step_y};
      hits += octree.occluded(ray, visitor) ? 1U : 0U;
    }
  }
  return hits;
}

TEST_P(EyeRayHits, WithinFourOfThePublished) {
  const std::uint64_t hits = eye_ray_hits(scenes::make_procedural(GetParam().scene));
  EXPECT_NEAR(static_cast<double>(hits), static_cast<double>(GetParam().hits), 4.0);
  RecordProperty("hits", std::to_string(hits));
}

// The SPD's files hold six significant digits; the recipe has seven.
TEST(TetraEyeRayHits, AreThePublishedOnesFromThePublishedCamera) {
  scenes::Scene scene = scenes::make_procedural("tetra:6");
  for (glm::dvec3* point : {&scene.camera.eye, &scene.camera.at, &scene.camera.up}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), "%g", (*point)[axis]);
      (*point)[axis] = std::strtod(text.data(), nullptr);
    }
  }
  EXPECT_EQ(eye_ray_hits(scene), 49950U);
}
INSTANTIATE_TEST_SUITE_P(Structures, EyeRayHits,
                         ::testing::Values(EyeRays{"gears:4", 245332}, EyeRays{"teapot:12", 161546},
                                           EyeRays{"tetra:6", 49950}),
                         [](const auto& tested) {
                           std::string name = tested.param.scene;
                           name[name.find(':')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace marti::tests
