// A closed mesh leaks no ray, wherever it is and however large.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <ostream>
#include <vector>

#include "accel/structure.h"
#include "studies/stability/icosphere.h"
#include "tests/contract/hostile.h"

namespace marti::tests {
namespace {

using studies::stability::Icosphere;

/// How the sphere is moved and scaled.
struct Place {
  double offset;
  double size;
};
void PrintTo(const Place& place, std::ostream* out) {
  *out << "size " << place.size << " at " << place.offset;
}
class ClosedMesh : public ::testing::TestWithParam<Place> {};

// 5 places x 210,000 rays are 1,050,000.
TEST_P(ClosedMesh, LeaksNoRay) {
  const Icosphere sphere(4);
  ASSERT_EQ(sphere.faces.size(), 5120U);
  const auto [offset, size] = GetParam();
  std::vector<glm::dvec3> vertices;
  for (const glm::dvec3& v : sphere.vertices) {
    vertices.push_back(glm::dvec3(offset, -offset, 0.5 * offset) + size * v);
  }
  std::vector<accel::TriangleCorners> all;
  for (const auto& face : sphere.faces) {
    all.push_back(studies::stability::corners(vertices[face[0]], vertices[face[1]], vertices[face[2]]));
  }
  const auto triangles = std::make_shared<const accel::TriangleSet>(all);
  const auto octree = accel::make_structure("octree", triangles);
  const auto bsp = accel::make_structure("bsp", triangles);
  accel::StructureOptions options;
  options.bsp.walk = accel::BspWalk::push_point;
  const auto push_point = accel::make_structure("bsp", triangles, options);
  const auto grid = accel::make_structure("grid", triangles);
  const auto bvh = accel::make_structure("bvh", triangles);
  Random random(41);
  std::uint64_t leaks = 0;
  for (int k = 0; k < 210000; ++k) {
    accel::Ray ray;
    ray.origin = glm::dvec3(offset, -offset, 0.5 * offset) + 0.9 * size * random.unit() * random.direction();
    const auto& face = sphere.faces[random.below(static_cast<std::uint32_t>(sphere.faces.size()))];
    const glm::dvec3 a = vertices[face[random.below(3)]];
    const glm::dvec3 b = k % 3 == 0 ? a : vertices[face[random.below(3)]];
    ray.direction = a + random.unit() * (b - a) - ray.origin;
    for (const accel::Structure* structure :
         {octree.get(), bsp.get(), push_point.get(), grid.get(), bvh.get()}) {
      leaks += structure->closest(ray).found() && structure->occluded(ray) ? 0U : 1U;
    }
  }
  EXPECT_EQ(leaks, 0U);
}
INSTANTIATE_TEST_SUITE_P(Structures, ClosedMesh,
                         ::testing::Values(Place{0, 1}, Place{1e3, 1}, Place{1e6, 1}, Place{0, 1e18},
                                           Place{1e-15, 1e-18}),
                         [](const auto& tested) { return std::to_string(tested.index); });

}  // namespace
}  // namespace marti::tests
