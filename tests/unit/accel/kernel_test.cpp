#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "tests/contract/hostile.h"
#include "tests/support/kernel_check.h"
#include "tests/support/long_tests.h"

namespace marti::tests {
namespace {

using accel::Best;
using accel::Hit;
using accel::Ray;
using accel::RaySetup;
using accel::TriangleCorners;
using tests::Aimed;
using tests::random_aimed;
using tests::test_one;

const TriangleCorners unit_triangle = tests::corners({0, 0, 2}, {1, 0, 2}, {0, 1, 2});

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

// The error bound the structures rely on: the point of the ray at t lies on the triangle, to 2^-40 of the
// sizes involved, however thin the triangle looks from the ray.
TEST(Kernel, HitsLieOnTheTriangleEvenEdgeOn) {
  Random random(13);
  int hits = 0;
  double worst = 0.0;
  for (int k = 0; k < test::cases(1000000); ++k) {
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
    const Hit hit = test_one(ray, tests::corners(a, b, c));
    if (!hit.found()) {
      continue;
    }
    ++hits;
    ASSERT_GE(std::min({hit.u, hit.v, hit.w}), 0.0);
    const glm::dvec3 on_ray = ray.origin + hit.t * ray.direction;
    const glm::dvec3 on_triangle = hit.u * a + hit.v * b + hit.w * c;
    worst = std::max(worst, glm::length(on_ray - on_triangle));
  }
  EXPECT_GT(hits, test::cases(100000));
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
