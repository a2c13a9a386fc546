// Rays that begin on a surface: they neither hit it again nor begin behind the next one.
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "accel/octree.h"
#include "processors/program/shading.h"
#include "tests/stability/placed_sphere.h"
#include "tests/support/long_tests.h"

namespace marti::tests {
namespace {

using accel::Hit;
using accel::Ray;
using Vec = processors::program::Vec3<double>;

processors::program::Surface<double> surface_of(const scenes::Scene& scene, const Ray& eye, const Hit& hit) {
  const double weights[3] = {hit.u, hit.v, hit.w};
  return processors::program::surface_at(scene, hit.primitive, weights, Vec(eye.direction), 0.0);
}

Ray leaving(const processors::program::Surface<double>& surface, const Vec& direction) {
  const Vec origin = processors::program::leave(surface, direction);
  Ray ray{{origin.x, origin.y, origin.z}, {direction.x, direction.y, direction.z}};
  ray.t_min = std::numeric_limits<double>::denorm_min();
  return ray;
}

// From the surface of a convex mesh every ray outwards is free, and every ray inwards hits.
TEST(SurfaceOrigins, OutwardsIsFreeAndInwardsIsNot) {
  for (const auto& [offset, scale] : {std::pair{0.0, 1.0}, {1e4, 1.0}, {1e5, 1.0}, {0.0, 1e-5}, {0.0, 1e5}}) {
    const PlacedSphere mesh(4, offset, scale);
    const accel::Octree octree = accel::Octree::build(std::make_shared<const accel::TriangleSet>(mesh.scene));
    accel::NullVisitor visitor;
    Random random(51);
    for (std::size_t k = test::stride(2'000, 20'000); k > 0; --k) {
      Ray eye{mesh.center + 3.0 * scale * random.direction(), {}};
      eye.direction = mesh.center + 0.5 * scale * random.direction() - eye.origin;
      const Hit hit = octree.closest(eye, visitor);
      ASSERT_TRUE(hit.found());
      const processors::program::Surface<double> surface = surface_of(mesh.scene, eye, hit);
      const Vec direction(random.direction());
      const double cosine = processors::program::dot(surface.geometric, direction);
      if (std::abs(cosine) < 0.01) {
        continue;  // grazing: whether a triangle of a rounded mesh is met is a matter of that rounding
      }
      ASSERT_EQ(octree.closest(leaving(surface, direction), visitor).found(), cosine < 0.0)
          << "at " << offset << " of size " << scale;
    }
  }
}

// Two sheets 2^-k apart, seen from below: the ray that leaves the first upwards must hit the second. Gaps
// from 2^8 steps of the doubles there on are seen: the error bound is gamma(7) of the coordinates and 2^-48
// of the triangle, some 64 steps and a few more.
TEST(SurfaceOrigins, ThinGapsAreNotJumpedOver) {
  constexpr double height = 16.5;
  int narrowest = -1;
  const double step = std::nextafter(height, 2.0 * height) - height;
  for (int k = 30; k >= 0; --k) {
    const double upper = height + std::ldexp(step, k);
    scenes::Scene scene;
    for (const double z : {height, upper}) {
      const auto first = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.insert(scene.positions.end(), {{-1, -1, z}, {3, -1, z}, {-1, 3, z}});
      scene.triangles.push_back({{first, first + 1, first + 2}, 0, 0});
    }
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const accel::Octree octree = accel::Octree::build(triangles);
    accel::NullVisitor visitor;
    const Ray eye{{0.2, 0.1, height - 1.0}, {0.05, 0.03, 1.0}};
    const Hit hit = octree.closest(eye, visitor);
    const Ray ray = leaving(surface_of(scene, eye, hit), Vec(0.05, 0.03, 1.0));
    if (hit.primitive != 0 || octree.closest(ray, visitor).primitive != 1) {
      break;
    }
    narrowest = k;
  }
  EXPECT_GE(narrowest, 0);
  EXPECT_LE(narrowest, 8);
}

}  // namespace
}  // namespace marti::tests
