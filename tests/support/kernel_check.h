// The ray/triangle kernel by itself, and a visitor that counts its tests.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "accel/watertight.h"
#include "tests/contract/hostile.h"

namespace marti::tests {

inline int sign(double x) { return x > 0.0 ? 1 : (x < 0.0 ? -1 : 0); }

/// The sign of a * b - c * d, exact barring underflow: where the rounded products are equal their rounding
/// errors decide. Not inlined: a product that is also used here would not be contracted there.
[[gnu::noinline]] inline int exact_sign(double a, double b, double c, double d) {
  const volatile double p = a * b;
  const volatile double q = c * d;
  return p != q ? sign(p - q) : sign(std::fma(a, b, -p) - std::fma(c, d, -q));
}

/// The hit of one triangle.
template <class Real = double>
accel::Hit test_one(const accel::Ray& ray, const accel::TriangleCorners& triangle, std::uint32_t id = 0) {
  const accel::RaySetup<Real> setup(ray);
  accel::Best<Real> best(setup);
  (void)accel::intersect(setup, triangle, id, best);
  return best.hit();
}

/// A ray that has a good chance of hitting, and a triangle.
struct Aimed {
  accel::Ray ray;
  accel::TriangleCorners triangle;
};

inline Aimed random_aimed(Random& random) {
  const glm::dvec3 a = random.direction();
  const glm::dvec3 b = random.direction();
  const glm::dvec3 c = random.direction();
  accel::Ray ray{2.0 * random.direction(), {}};
  const double u = random.unit();
  const double v = random.unit();
  ray.direction = (1 - u) * a + u * (1 - v) * b + u * v * c + 0.1 * random.direction() - ray.origin;
  return {ray, corners(a, b, c)};
}

/// Counts tests.
struct TestCounter {
  std::uint64_t tests = 0;
  void branch(std::uint32_t /*node*/) {}
  void transform(std::uint32_t /*node*/) {}
  void leaf(std::uint32_t /*node*/, std::uint32_t tested, std::uint32_t /*entries*/) { tests += tested; }
  void mailed_leaf(std::uint32_t /*node*/, std::uint32_t read, std::uint32_t /*entries*/,
                   const std::uint32_t* tested) {
    for (std::uint32_t k = 0; k < read; k += 32) {
      tests += static_cast<std::uint64_t>(std::popcount(tested[k / 32]));
    }
  }
};

}  // namespace marti::tests
