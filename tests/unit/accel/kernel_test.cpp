#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "studies/stability/kernel_check.h"
#include "tests/contract/hostile.h"

namespace marti::tests {
namespace {

using accel::Best;
using accel::Hit;
using accel::Ray;
using accel::RaySetup;
using accel::TriangleCorners;
using studies::Aimed;
using studies::random_aimed;
using studies::test_one;

const TriangleCorners unit_triangle = corners({0, 0, 2}, {1, 0, 2}, {0, 1, 2});

TEST(Kernel, GivesTheParameterAndTheWeights) {
  for (const double length : {1.0, 0.25, -0.5}) {
    const Ray ray{{0.25, 0.5, length > 0 ? 0.0 : 4.0}, {0, 0, length}};
    const Hit hit = test_one(ray, unit_triangle);
    EXPECT_EQ(hit.t, 2.0 / std::abs(length));
    EXPECT_EQ(hit.u, 0.25);
    EXPECT_EQ(hit.v, 0.25);
    EXPECT_EQ(hit.w, 0.5);
  }
  EXPECT_FALSE(test_one({{0.75, 0.5, 0}, {0, 0, 1}}, unit_triangle).found());
}

TEST(Kernel, BothLimitsAreInclusive) {
  Ray ray{{0.25, 0.25, 0}, {0, 0, 1}};
  ray.t_max = 2.0;
  EXPECT_TRUE(test_one(ray, unit_triangle).found());
  ray.t_max = std::nextafter(2.0, 0.0);
  EXPECT_FALSE(test_one(ray, unit_triangle).found());
  ray.t_max = 5.0;
  ray.t_min = 2.0;
  EXPECT_TRUE(test_one(ray, unit_triangle).found());
  ray.t_min = std::nextafter(2.0, 3.0);
  EXPECT_FALSE(test_one(ray, unit_triangle).found());
}

TEST(Kernel, EqualParametersGoToTheLowestId) {
  const RaySetup<double> setup({{0.25, 0.25, 0}, {0, 0, 1}});
  for (const std::array<std::uint32_t, 3>& order :
       {std::array<std::uint32_t, 3>{5, 3, 9}, {3, 9, 5}, {9, 5, 3}, {9, 3, 5}}) {
    Best<double> best(setup);
    for (const std::uint32_t id : order) {
      accel::intersect(setup, unit_triangle, id, best);
    }
    EXPECT_EQ(best.primitive, 3U);
  }
}

TEST(Kernel, ZeroAreaIsNeverHit) {
  Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const glm::dvec3 a(random.below(8), random.below(8), random.below(8));
    const glm::dvec3 step(random.below(3), random.below(3), random.below(3));
    // Rays through the degenerate triangle itself, along an axis: all sheared corners are exact.
    Ray ray{a - glm::dvec3(0, 0, 9), {0, 0, 1}};
    EXPECT_FALSE(test_one(ray, corners(a, a + step, a + 2.0 * step)).found());
    EXPECT_FALSE(test_one(ray, corners(a, a, a)).found());
  }
}

// Vulkan's closed fan: a ray through the common corner hits at least one of k triangles.
TEST(Kernel, FansAreClosedAtTheirApex) {
  Random random(5);
  for (int k = 3; k <= 64; ++k) {
    for (int trial = 0; trial < 300; ++trial) {
      const double offset = trial % 3 == 0 ? 0.0 : (trial % 3 == 1 ? 1e3 : 1e6);
      const glm::dvec3 apex = glm::dvec3(offset) + random.direction();
      const glm::dvec3 toward = random.direction();
      Ray ray;
      ray.origin = apex - random.between(0.5, 4.0) * toward;
      ray.direction = apex - ray.origin;
      const glm::dvec3 s = glm::normalize(glm::cross(toward, random.direction()));
      const glm::dvec3 r = glm::cross(toward, s);
      std::vector<glm::dvec3> rim;
      for (int i = 0; i < k; ++i) {
        const double angle = 6.283185307179586 * (i + random.between(-0.3, 0.3)) / k;
        rim.push_back(apex + std::cos(angle) * s + std::sin(angle) * r + random.between(-0.2, 0.2) * toward);
      }
      const RaySetup<double> setup(ray);
      Best<double> best(setup);
      for (int i = 0; i < k; ++i) {
        const auto next = static_cast<std::size_t>((i + 1) % k);
        accel::intersect(setup, corners(apex, rim[static_cast<std::size_t>(i)], rim[next]),
                         static_cast<std::uint32_t>(i), best);
      }
      ASSERT_TRUE(best.found()) << "fan of " << k << ", trial " << trial;
    }
  }
}

TEST(Kernel, TurningTheAxesChangesNothing) {
  Random random(7);
  int hits = 0;
  for (int k = 0; k < 300000; ++k) {
    const Aimed original = random_aimed(random);
    Aimed turned = original;
    for (int a = 0; a < 3; ++a) {
      turned.ray.origin[(a + 1) % 3] = original.ray.origin[a];
      turned.ray.direction[(a + 1) % 3] = original.ray.direction[a];
      for (std::size_t c = 0; c < 3; ++c) {
        turned.triangle[3 * c + static_cast<std::size_t>((a + 1) % 3)] =
            original.triangle[3 * c + static_cast<std::size_t>(a)];
      }
    }
    const Hit expected = test_one(original.ray, original.triangle);
    const Hit got = test_one(turned.ray, turned.triangle);
    hits += expected.found() ? 1 : 0;
    ASSERT_TRUE(expected.found() == got.found() && expected.t == got.t && expected.u == got.u);
  }
  EXPECT_GT(hits, 100000);
}

TEST(Kernel, MirroringChangesNothing) {
  Random random(9);
  for (int k = 0; k < 300000; ++k) {
    const Aimed original = random_aimed(random);
    Aimed mirrored = original;
    const auto axis = static_cast<std::size_t>(k % 3);
    mirrored.ray.origin[static_cast<int>(axis)] *= -1.0;
    mirrored.ray.direction[static_cast<int>(axis)] *= -1.0;
    for (std::size_t c = 0; c < 3; ++c) {
      mirrored.triangle[3 * c + axis] *= -1.0;
    }
    const Hit expected = test_one(original.ray, original.triangle);
    const Hit got = test_one(mirrored.ray, mirrored.triangle);
    ASSERT_TRUE(expected.found() == got.found() && expected.t == got.t && expected.u == got.u);
  }
}

// The order of the corners may move t in its last bits but never turns a hit into a miss.
TEST(Kernel, OrderOfCornersDecidesNothing) {
  Random random(11);
  for (int k = 0; k < 300000; ++k) {
    const Aimed c = random_aimed(random);
    const TriangleCorners& t = c.triangle;
    const TriangleCorners turned{t[3], t[4], t[5], t[6], t[7], t[8], t[0], t[1], t[2]};
    const TriangleCorners flipped{t[3], t[4], t[5], t[0], t[1], t[2], t[6], t[7], t[8]};
    const bool expected = test_one(c.ray, t).found();
    ASSERT_EQ(expected, test_one(c.ray, turned).found());
    ASSERT_EQ(expected, test_one(c.ray, flipped).found());
  }
}

// The error bound the structures rely on: the point of the ray at t lies on the triangle, to 2^-40 of the
// sizes involved, however thin the triangle looks from the ray.
TEST(Kernel, HitsLieOnTheTriangleEvenEdgeOn) {
  Random random(13);
  int hits = 0;
  double worst = 0.0;
  for (int k = 0; k < 1000000; ++k) {
    const glm::dvec3 a = random.direction();
    const glm::dvec3 b = random.direction();
    glm::dvec3 c = random.direction();
    if (k % 2 == 0) {  // a needle
      c = b + std::ldexp(1.0, -static_cast<int>(random.below(53))) * random.direction();
    }
    const glm::dvec3 p = a + random.unit() * (b - a);
    const glm::dvec3 q = b + random.unit() * (c - b);
    // From a point that is nearly in the triangle's plane.
    Ray ray;
    ray.origin = p + random.between(1.0, 3.0) * (p - q) +
                 std::ldexp(1.0, -static_cast<int>(random.below(60))) * random.direction();
    ray.direction = q - ray.origin;
    const Hit hit = test_one(ray, corners(a, b, c));
    if (!hit.found()) {
      continue;
    }
    ++hits;
    ASSERT_GE(std::min({hit.u, hit.v, hit.w}), 0.0);
    const glm::dvec3 on_ray = ray.origin + hit.t * ray.direction;
    const glm::dvec3 on_triangle = hit.u * a + hit.v * b + hit.w * c;
    worst = std::max(worst, glm::length(on_ray - on_triangle));
  }
  EXPECT_GT(hits, 100000);
  EXPECT_LT(worst, 0x1p-40);
  RecordProperty("worst", std::to_string(std::log2(worst)));
}

TEST(Kernel, SpeedOfTheRayOnlyScalesTheParameter) {
  Random random(17);
  for (int k = 0; k < 100000; ++k) {
    const Aimed c = random_aimed(random);
    const Hit expected = test_one(c.ray, c.triangle);
    Ray fast = c.ray;
    const int power = static_cast<int>(random.below(400)) - 200;
    fast.direction *= std::ldexp(1.0, power);
    const Hit got = test_one(fast, c.triangle);
    ASSERT_EQ(expected.found(), got.found());
    if (expected.found()) {
      ASSERT_EQ(expected.t, std::ldexp(got.t, power));
    }
  }
}

}  // namespace
}  // namespace marti::tests
