// Cutting spheres, cylinders and cones into triangles: how far the facets are from the surface, which way
// they face, and that nothing is left open that was closed.
#include "scenes/tessellate.h"

#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "scenes/open.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace marti::scenes {
namespace {

Scene one(const Quadric& quadric) {
  Scene scene;
  scene.materials.resize(2);
  scene.quadrics.push_back(quadric);
  tessellate(scene);
  return scene;
}

/// Signed distance from the cone's surface, perpendicular to its axis.
double excess(const Quadric& q, const glm::dvec3& p) {
  if (q.kind == QuadricKind::sphere) {
    return glm::length(p - q.base) - q.radius;
  }
  const glm::dvec3 axis = glm::normalize(q.tip - q.base);
  const double h = glm::dot(p - q.base, axis);
  const double share = h / glm::length(q.tip - q.base);
  return glm::length(p - q.base - h * axis) - (q.radius + share * (q.end_radius() - q.radius));
}

TEST(Tessellate, FacetsAreNearTheSurfaceAndFaceOutwards) {
  const glm::dvec3 a(1.0, -2.0, 3.0);
  const glm::dvec3 b(2.0, 0.5, 4.0);
  for (const auto& [quadric, count] :
       {std::pair{Quadric{.kind = QuadricKind::sphere, .base = a, .radius = 2.0}, 528U},
        std::pair{Quadric{.kind = QuadricKind::cylinder, .base = a, .tip = b, .radius = 2.0}, 48U},
        std::pair{Quadric{.kind = QuadricKind::cone, .base = a, .tip = b, .radius = 1.0, .tip_radius = 2.0},
                  48U},
        std::pair{Quadric{.kind = QuadricKind::cone, .base = a, .tip = b, .radius = 2.0, .tip_radius = 0.0},
                  24U},
        std::pair{Quadric{.kind = QuadricKind::cone, .base = a, .tip = b, .radius = 0.0, .tip_radius = 2.0},
                  24U}}) {
    const Scene scene = one(quadric);
    EXPECT_TRUE(scene.quadrics.empty());
    EXPECT_EQ(scene.triangles.size(), count);
    EXPECT_EQ(scene.polygons, 1U);
    EXPECT_EQ(scene.normals.size(), scene.positions.size());
    EXPECT_EQ(facts_of(scene).degenerate_triangles, 0U);
    ASSERT_EQ(scene.notes.size(), 1U);
    const double tolerance = quadric.kind == QuadricKind::sphere ? 0.018 : 0.009;
    for (const Triangle& triangle : scene.triangles) {
      const glm::dvec3& p = scene.positions[triangle.vertex[0]];
      const glm::dvec3& q = scene.positions[triangle.vertex[1]];
      const glm::dvec3& r = scene.positions[triangle.vertex[2]];
      const glm::dvec3 own = glm::normalize(glm::cross(q - p, r - p));
      for (const std::uint32_t vertex : triangle.vertex) {
        EXPECT_NEAR(excess(quadric, scene.positions[vertex]), 0.0, 1e-14);
        EXPECT_GT(glm::dot(own, scene.normals[vertex]), 0.95);
      }
      for (int i = 0; i <= 10; ++i) {
        for (int j = 0; i + j <= 10; ++j) {
          const double e = excess(quadric, (i * p + j * q + (10 - i - j) * r) / 10.0);
          EXPECT_LT(e, 1e-14);
          EXPECT_GT(e, -tolerance * 2.0);
        }
      }
    }
  }
}

TEST(Tessellate, SpheresAreClosed) {
  const Scene scene = one({.kind = QuadricKind::sphere, .base = {1.0, 2.0, 3.0}, .radius = 0.7});
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const Triangle& triangle : scene.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle.vertex[k];
      const std::uint32_t b = triangle.vertex[(k + 1) % 3];
      a < b ? ++balance[{a, b}] : --balance[{b, a}];
    }
  }
  for (const auto& [edge, count] : balance) {
    EXPECT_EQ(count, 0);
  }
}

TEST(Tessellate, KeepsWhatIsThere) {
  Scene scene = make_procedural("rings:1");
  const std::size_t own = scene.triangles.size();
  const Bounds before = bounds_of(scene);
  tessellate(scene);
  EXPECT_EQ(scene.triangles.size(), own + 30 * 528 + 30 * 48);
  EXPECT_EQ(scene.triangles[own + 48].material, scene.triangles[own].material);
  EXPECT_EQ(scene.polygons, 61U);
  const Bounds after = bounds_of(scene);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(after.lo[axis], before.lo[axis], 0.002);
    EXPECT_NEAR(after.hi[axis], before.hi[axis], 0.002);
  }
  const std::size_t vertices = scene.positions.size();
  tessellate(scene);
  EXPECT_EQ(scene.positions.size(), vertices) << "nothing left to do";
  Scene bad;
  bad.quadrics.push_back({.radius = -1.0});
  EXPECT_THROW(tessellate(bad), sim::UserError);
}

}  // namespace
}  // namespace marti::scenes
