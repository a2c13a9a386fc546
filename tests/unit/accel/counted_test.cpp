#include <gtest/gtest.h>

#include "accel/counted.h"
#include "accel/octree.h"
#include "tests/contract/hostile.h"

namespace marti::tests {
namespace {

using accel::Counted;
using accel::CountedInt;
using accel::operation_counts;
using accel::OperationCounts;

template <class F>
OperationCounts count(F&& f) {
  const OperationCounts before = operation_counts();
  f();
  return operation_counts() - before;
}

TEST(CountedScalar, EveryOperationIsCountedOnceAsDocumented) {
  const Counted a(3.0);
  const Counted b(4.0);
  EXPECT_EQ(count([&] { EXPECT_EQ((a + b).value(), 7.0); }), (OperationCounts{.add = 1}));
  EXPECT_EQ(count([&] { EXPECT_EQ((a - b).value(), -1.0); }), (OperationCounts{.add = 1}));
  EXPECT_EQ(count([&] { EXPECT_EQ((a * b).value(), 12.0); }), (OperationCounts{.multiply = 1}));
  EXPECT_EQ(count([&] { EXPECT_EQ((a / b).value(), 0.75); }), (OperationCounts{.divide = 1}));
  EXPECT_EQ(count([&] { EXPECT_EQ(sqrt(b).value(), 2.0); }), (OperationCounts{.square_root = 1}));
  EXPECT_EQ(count([&] { EXPECT_EQ((-a).value(), -3.0); }), OperationCounts{});
  EXPECT_EQ(count([&] { EXPECT_EQ(abs(-a).value(), 3.0); }), (OperationCounts{.compare = 1}));
  EXPECT_EQ(count([&] { EXPECT_EQ(min(a, b).value(), 3.0); }), (OperationCounts{.compare = 1}));
  EXPECT_EQ(count([&] { EXPECT_EQ(max(a, b).value(), 4.0); }), (OperationCounts{.compare = 1}));
  EXPECT_EQ(count([&] { EXPECT_TRUE(a < b && a <= b && b > a && b >= a && a != b); }),
            (OperationCounts{.compare = 5}));
  EXPECT_EQ(count([&] { EXPECT_EQ(fma(a, b, a).value(), 15.0); }),
            (OperationCounts{.add = 1, .multiply = 1}));
  EXPECT_EQ(count([&] {
              Counted c = a;
              c += b;
              c *= b;
            }),
            (OperationCounts{.add = 1, .multiply = 1}));
}

TEST(CountedScalar, IntegersToo) {
  const CountedInt a(6U);
  const CountedInt b(3U);
  EXPECT_EQ(count([&] { EXPECT_EQ(((a + b) ^ (a & b) ^ (a | 1U)).value(), 9U ^ 2U ^ 7U); }),
            (OperationCounts{.integer = 5}));
  EXPECT_EQ(count([&] { EXPECT_TRUE(a > b && (a >> 1U) == b); }), (OperationCounts{.integer = 3}));
}

// A triangle that fails the sign test costs 3 differences and 2 shears (2 multiply, 2 + 2 add) a corner, 6
// products and 3 differences: this is the number the cost model is built on.
TEST(CountedScalar, CountsTheKernel) {
  const accel::RaySetup<Counted> setup({{5.0, 5.0, 0.0}, {0.0, 0.0, 1.0}});
  accel::Best<Counted> best(setup);
  const OperationCounts counts = count([&] {
    EXPECT_FALSE(accel::intersect(setup, tests::corners({0, 0, 2}, {1, 0, 2}, {0, 1, 2}), 0, best));
  });
  EXPECT_EQ(counts.add, 18U);
  EXPECT_EQ(counts.multiply, 12U);
  EXPECT_EQ(counts.divide, 0U);
}

}  // namespace
}  // namespace marti::tests
