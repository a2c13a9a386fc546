// Fails when the compiler contracts products into fused multiply-adds. This file is compiled with the
// project's own options plus, on x86-64, -mfma: without it the machine has no fused instruction and a lost
// -ffp-contract=off would go unnoticed until marti is built for another machine.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "accel/watertight.h"
#include "tests/contract/hostile.h"
#include "tests/support/kernel_check.h"

namespace marti::tests {
namespace {

bool fused_instructions_run_here() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("fma") != 0;
#else
  return true;
#endif
}

using tests::exact_sign;
using tests::sign;

TEST(Contraction, SignsOfEdgeFunctionsAreExact) {
  if (!fused_instructions_run_here()) {
    GTEST_SKIP() << "this processor has no fused multiply-add";
  }
  Random random(1);
  int wrong = 0;
  int asymmetric = 0;
  int zeros = 0;
  for (int k = 0; k < 2000000; ++k) {
    // Two vectors collinear but for rounding.
    const double ax = random.between(-1, 1);
    const double ay = random.between(-1, 1);
    const double s = random.between(0.5, 2);
    const double bx = ax * s;
    const double by = ay * s;
    const double forward = ax * by - ay * bx;
    const double backward = bx * ay - by * ax;
    wrong += forward != 0.0 && sign(forward) != exact_sign(ax, by, ay, bx) ? 1 : 0;
    asymmetric += forward != -backward ? 1 : 0;
    zeros += forward == 0.0 ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(asymmetric, 0);
  EXPECT_GT(zeros, 10000);  // the pairs were near enough to collinear to try the rounding
}

// The kernel itself: rays at the shared edge of two triangles whose vertices are nearly in line with it.
TEST(Contraction, KernelLeavesNoGapOnASharedEdge) {
  if (!fused_instructions_run_here()) {
    GTEST_SKIP() << "this processor has no fused multiply-add";
  }
  Random random(2);
  int leaks = 0;
  for (int k = 0; k < 500000; ++k) {
    const glm::dvec3 a(random.between(-1, 1), random.between(-1, 1), 1.0);
    const glm::dvec3 b(random.between(-1, 1), random.between(-1, 1), 1.0);
    const glm::dvec3 side = glm::cross(b - a, glm::dvec3(0, 0, 1));
    accel::Ray ray;
    ray.direction = a + random.unit() * (b - a);
    const accel::RaySetup<double> setup(ray);
    accel::Best<double> best(setup);
    accel::intersect(setup, tests::corners(a, b, 0.5 * (a + b) + side), 0, best);
    accel::intersect(setup, tests::corners(b, a, 0.5 * (a + b) - side), 1, best);
    leaks += best.found() ? 0 : 1;
  }
  EXPECT_EQ(leaks, 0);
}

}  // namespace
}  // namespace marti::tests
