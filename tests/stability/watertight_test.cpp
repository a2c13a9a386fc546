// The ray/triangle kernel leaves no gap between triangles that meet, hits nothing that has no area, and does
// not see which axis is which.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "accel/structure.h"
#include "sim/error.h"
#include "tests/stability/placed_sphere.h"
#include "tests/support/kernel_check.h"
#include "tests/support/long_tests.h"
#include "tests/support/same_bits.h"

namespace marti::tests {
namespace {

using accel::Best;
using accel::Ray;
using accel::RaySetup;
using accel::TriangleCorners;

const auto rays = static_cast<std::uint32_t>(test::stride(2'000, 20'000));

// A ray through the common corner of 3 to 64 triangles that close around it.
TEST(Watertight, AFanIsHitInItsMiddle) {
  Random random(5);
  for (std::uint32_t trial = 0; trial < rays; ++trial) {
    const auto k = static_cast<std::size_t>(3 + trial % 62);
    const std::array<double, 3> offsets{0.0, 1e3, 1e6};
    const glm::dvec3 apex = glm::dvec3(offsets[trial % 3]) + random.direction();
    const glm::dvec3 toward = random.direction();
    Ray ray;
    ray.origin = apex - random.between(0.5, 4.0) * toward;
    ray.direction = apex - ray.origin;
    const glm::dvec3 s = glm::normalize(glm::cross(toward, random.direction()));
    const glm::dvec3 r = glm::cross(toward, s);
    // No two neighbours are half a turn apart, or a fan of three would not be closed around the ray.
    std::vector<glm::dvec3> rim;
    for (std::size_t i = 0; i < k; ++i) {
      const double angle =
          6.283185307179586 * (static_cast<double>(i) + random.between(-0.2, 0.2)) / static_cast<double>(k);
      rim.push_back(apex + std::cos(angle) * s + std::sin(angle) * r + random.between(-0.2, 0.2) * toward);
    }
    const RaySetup<double> setup(ray);
    Best<double> best(setup);
    for (std::size_t i = 0; i < k; ++i) {
      (void)accel::intersect(setup, corners(apex, rim[i], rim[(i + 1) % k]), static_cast<std::uint32_t>(i),
                             best);
    }
    ASSERT_TRUE(best.found()) << "fan " << trial;
  }
}

// Leaks are rare: a long run tries a million rays.
TEST(Watertight, NoRayLeavesAClosedMesh) {
  const auto each = static_cast<std::uint32_t>(test::stride(8'000, 40'000));
  for (const auto& [offset, size] :
       {std::pair{0.0, 1.0}, {1e3, 1.0}, {1e6, 1.0}, {1e9, 1.0}, {1e-15, 1e-18}, {0.0, 1e18}}) {
    const PlacedSphere mesh(4, offset, size);
    const auto triangles = std::make_shared<const accel::TriangleSet>(mesh.scene);
    for (const char* const kind : {"octree", "bsp", "grid", "bvh"}) {
      const auto structure = accel::make_structure(kind, triangles);
      Random random(41);
      for (std::uint32_t k = 0; k < each; ++k) {
        const Ray ray = mesh.from_inside(random, k);
        ASSERT_TRUE(structure->closest(ray).found()) << kind << " at " << offset << " of size " << size;
        ASSERT_TRUE(structure->occluded(ray));
      }
    }
  }
}

// Moeller and Trumbore's test in floats, which is known to leak.
bool moeller_trumbore(const accel::Ray& ray, const accel::TriangleCorners& t) {
  using Vec = std::array<float, 3>;
  const auto at = [](double x) { return static_cast<float>(x); };
  const auto minus = [](const Vec& a, const Vec& b) { return Vec{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto cross = [](const Vec& a, const Vec& b) {
    return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto dot = [](const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const Vec o{at(ray.origin.x), at(ray.origin.y), at(ray.origin.z)};
  const Vec d{at(ray.direction.x), at(ray.direction.y), at(ray.direction.z)};
  const Vec a{at(t[0]), at(t[1]), at(t[2])};
  const Vec ab = minus({at(t[3]), at(t[4]), at(t[5])}, a);
  const Vec ac = minus({at(t[6]), at(t[7]), at(t[8])}, a);
  const Vec p = cross(d, ac);
  const float det = dot(ab, p);
  if (det == 0.0F) {
    return false;
  }
  const Vec s = minus(o, a);
  const float u = dot(s, p) / det;
  const Vec q = cross(s, ab);
  const float v = dot(d, q) / det;
  return u >= 0.0F && v >= 0.0F && u + v <= 1.0F && dot(ac, q) / det > 0.0F;
}

// In floats neither; and these rays find a kernel that does leak.
TEST(Watertight, NorInFloats) {
  const PlacedSphere mesh(2, 0.0, 1.0);
  const auto triangles = std::make_shared<const accel::TriangleSet>(mesh.scene);
  const accel::BruteForce brute(triangles);
  Random random(43);
  int lost = 0;
  for (std::uint32_t k = 0; k < 3000; ++k) {
    const Ray ray = mesh.from_inside(random, k);
    accel::NullVisitor visitor;
    ASSERT_TRUE(brute.closest<float>(ray, visitor).found());
    bool found = false;
    for (std::uint32_t id = 0; id < triangles->size() && !found; ++id) {
      found = moeller_trumbore(ray, (*triangles)[id]);
    }
    lost += found ? 0 : 1;
  }
  EXPECT_GT(lost, 0);
  EXPECT_LT(lost, 1000);
}

/// Changes each coordinate of origin, direction and corners.
template <class Change>
Aimed changed(const Aimed& aimed, const Change& change) {
  Aimed other = aimed;
  other.ray.origin = change(aimed.ray.origin);
  other.ray.direction = change(aimed.ray.direction);
  for (std::size_t c = 0; c < 9; c += 3) {
    const glm::dvec3 p = change(glm::dvec3(aimed.triangle[c], aimed.triangle[c + 1], aimed.triangle[c + 2]));
    other.triangle[c] = p.x;
    other.triangle[c + 1] = p.y;
    other.triangle[c + 2] = p.z;
  }
  return other;
}

// Turned axes and mirrored ones: the same hits, bit for bit; corners in another order: hit or not alike.
TEST(Watertight, AxesSidesAndTheOrderOfCornersDoNotMatter) {
  Random random(8);
  for (std::uint32_t k = 0; k < 10 * rays; ++k) {
    const Aimed aimed = random_aimed(random);
    const accel::Hit hit = test_one(aimed.ray, aimed.triangle);
    const Aimed turned = changed(aimed, [](const glm::dvec3& p) { return glm::dvec3(p.z, p.x, p.y); });
    ASSERT_TRUE(test::same_bits(hit, test_one(turned.ray, turned.triangle)));
    const auto axis = static_cast<int>(random.below(3));
    const Aimed mirrored = changed(aimed, [axis](glm::dvec3 p) {
      p[axis] = -p[axis];
      return p;
    });
    ASSERT_TRUE(test::same_bits(hit, test_one(mirrored.ray, mirrored.triangle)));
    const TriangleCorners& t = aimed.triangle;
    const TriangleCorners rotated{t[3], t[4], t[5], t[6], t[7], t[8], t[0], t[1], t[2]};
    const TriangleCorners reversed{t[6], t[7], t[8], t[3], t[4], t[5], t[0], t[1], t[2]};
    ASSERT_EQ(test_one(aimed.ray, rotated).found(), hit.found());
    ASSERT_EQ(test_one(aimed.ray, reversed).found(), hit.found());
  }
}

TEST(Watertight, NothingWithoutAreaIsHit) {
  Random random(3);
  for (std::uint32_t k = 0; k < rays; ++k) {
    // Whole coordinates and a ray along an axis: all sheared corners are exact, and so is the answer.
    const glm::dvec3 a(random.below(8), random.below(8), random.below(8));
    const glm::dvec3 step(random.below(3), random.below(3), random.below(3));
    const Ray ray{a - glm::dvec3(0, 0, 9), {0, 0, 1}};
    ASSERT_FALSE(test_one(ray, corners(a, a + step, a + 2.0 * step)).found());
    // Corners d, -d and 0 lie on a line exactly, whatever d is; once sheared and rounded they do not.
    const glm::dvec3 d = random.direction();
    const glm::dvec3 toward = random.direction();
    const accel::TriangleSet set(std::vector<TriangleCorners>{corners(d, -d, glm::dvec3(0.0))});
    ASSERT_FALSE(test_one({-4.0 * toward, toward}, set[0]).found());
  }
}

TEST(TriangleSets, CoordinatesThatAreNoNumbersAreRefused) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    std::vector<TriangleCorners> soup = hostile_soup(0.0, 61);
    soup[7][4] = value;
    EXPECT_THROW((void)accel::TriangleSet(std::move(soup)), sim::UserError);
  }
}

}  // namespace
}  // namespace marti::tests
