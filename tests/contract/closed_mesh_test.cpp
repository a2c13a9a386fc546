// A closed mesh leaks no ray, wherever it is and however large.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include "accel/structure.h"
#include "tests/contract/hostile.h"

namespace marti::tests {
namespace {

/// An icosahedron, each face cut into four `times` times, on the unit sphere.
struct Icosphere {
  std::vector<glm::dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;

  explicit Icosphere(int times) {
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-g, g}) {
        vertices.push_back(glm::normalize(glm::dvec3(a, b, 0)));
        vertices.push_back(glm::normalize(glm::dvec3(0, a, b)));
        vertices.push_back(glm::normalize(glm::dvec3(b, 0, a)));
      }
    }
    // The faces are the triples of mutual neighbours.
    const double edge = 2.0 / std::sqrt(1.0 + g * g) + 1e-9;
    const auto near = [&](std::uint32_t i, std::uint32_t j) {
      return glm::distance(vertices[i], vertices[j]) < edge;
    };
    for (std::uint32_t i = 0; i < 12; ++i) {
      for (std::uint32_t j = i + 1; j < 12; ++j) {
        for (std::uint32_t k = j + 1; k < 12; ++k) {
          if (near(i, j) && near(j, k) && near(i, k)) {
            faces.push_back({i, j, k});
          }
        }
      }
    }
    for (int t = 0; t < times; ++t) {
      refine();
    }
  }

  void refine() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      const auto [at, added] =
          middles.try_emplace(std::minmax(i, j), static_cast<std::uint32_t>(vertices.size()));
      if (added) {
        vertices.push_back(glm::normalize(vertices[i] + vertices[j]));
      }
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
};

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
    all.push_back(corners(vertices[face[0]], vertices[face[1]], vertices[face[2]]));
  }
  const auto triangles = std::make_shared<const accel::TriangleSet>(all);
  const auto octree = accel::make_structure("octree", triangles);
  const auto bsp = accel::make_structure("bsp", triangles);
  accel::StructureOptions options;
  options.bsp.walk = accel::BspWalk::push_point;
  const auto push_point = accel::make_structure("bsp", triangles, options);
  const auto grid = accel::make_structure("grid", triangles);
  Random random(41);
  std::uint64_t leaks = 0;
  for (int k = 0; k < 210000; ++k) {
    accel::Ray ray;
    ray.origin = glm::dvec3(offset, -offset, 0.5 * offset) + 0.9 * size * random.unit() * random.direction();
    const auto& face = sphere.faces[random.below(static_cast<std::uint32_t>(sphere.faces.size()))];
    const glm::dvec3 a = vertices[face[random.below(3)]];
    const glm::dvec3 b = k % 3 == 0 ? a : vertices[face[random.below(3)]];
    ray.direction = a + random.unit() * (b - a) - ray.origin;
    for (const accel::Structure* structure : {octree.get(), bsp.get(), push_point.get(), grid.get()}) {
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
