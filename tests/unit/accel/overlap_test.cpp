// The box test against exact integer arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "accel/box_overlap.h"
#include "tests/contract/hostile.h"
#include "tests/support/long_tests.h"

namespace marti::tests {
namespace {

__extension__ using Int128 = __int128;
using Point = std::array<std::int64_t, 3>;

/// Separating axes on integers, closed: exact while coordinates stay below 2^39.
bool exact_overlap(const std::array<Point, 3>& triangle, const Point& half) {
  const auto separated = [&](const std::array<Int128, 3>& axis) {
    Int128 lo = 0;
    Int128 hi = 0;
    Int128 r = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      Int128 p = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        p += axis[a] * triangle[c][a];
      }
      lo = c == 0 ? p : std::min(lo, p);
      hi = c == 0 ? p : std::max(hi, p);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      r += (axis[a] < 0 ? -axis[a] : axis[a]) * half[a];
    }
    return lo > r || hi < -r;
  };
  std::array<std::array<Int128, 3>, 3> edge{};
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t a = 0; a < 3; ++a) {
      edge[c][a] = triangle[(c + 1) % 3][a] - triangle[c][a];
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    std::array<Int128, 3> axis{};
    axis[a] = 1;
    if (separated(axis)) {
      return false;
    }
    for (const auto& e : edge) {
      std::array<Int128, 3> cross{};
      cross[(a + 1) % 3] = -e[(a + 2) % 3];
      cross[(a + 2) % 3] = e[(a + 1) % 3];
      if (separated(cross)) {
        return false;
      }
    }
  }
  const std::array<Int128, 3> normal{edge[0][1] * edge[1][2] - edge[0][2] * edge[1][1],
                                     edge[0][2] * edge[1][0] - edge[0][0] * edge[1][2],
                                     edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]};
  return !separated(normal);
}

/// Compares on `cases` random triangles within `range` of a box of half size up to `half_range`, moved by
/// `offset`; every fourth triangle touches a corner of the box. Returns how many overlapped.
int compare(std::int64_t range, std::int64_t half_range, double offset, int cases) {
  Random random(static_cast<std::uint64_t>(range) + 31);
  int overlapping = 0;
  const auto integer = [&](std::int64_t n) {
    return static_cast<std::int64_t>(random.between(-static_cast<double>(n), static_cast<double>(n) + 1.0));
  };
  for (int k = 0; k < cases; ++k) {
    Point half{};
    std::array<Point, 3> t{};
    for (std::size_t a = 0; a < 3; ++a) {
      half[a] = std::abs(integer(half_range)) + 1;
      for (auto& corner : t) {
        corner[a] = integer(range);
      }
    }
    if (k % 4 == 0) {  // through a corner of the box, with a point symmetric about it
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t s = (random.below(2) != 0 ? 1 : -1) * half[a];
        t[1][a] = 2 * s - t[0][a];
        if (k % 8 == 0) {
          t[2][a] = t[0][a];  // degenerate besides
        }
      }
    }
    const bool expected = exact_overlap(t, half);
    overlapping += expected ? 1 : 0;
    accel::TriangleCorners triangle{};
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t a = 0; a < 3; ++a) {
        triangle[3 * c + a] = offset + static_cast<double>(t[c][a]);
      }
    }
    const glm::dvec3 h(static_cast<double>(half[0]), static_cast<double>(half[1]),
                       static_cast<double>(half[2]));
    // On small integers the rounding bound is far below one: the answers are equal both ways.
    EXPECT_EQ(accel::overlaps(triangle, glm::dvec3(offset), h), expected);
    if (::testing::Test::HasFailure()) {
      break;
    }
  }
  return overlapping;
}

TEST(BoxOverlap, EqualsExactArithmeticOnIntegers) {
  EXPECT_GT(compare(8, 4, 0.0, test::cases(200000)), test::cases(20000));
  EXPECT_GT(compare(100, 60, 0.0, test::cases(200000)), test::cases(20000));
  EXPECT_GT(compare(3000, 2000, 1048576.0, test::cases(200000)), test::cases(20000));
}

// With large numbers the products round: never a false "no".
TEST(BoxOverlap, NeverMissesWhatTouches) {
  Random random(77);
  for (int k = 0; k < test::cases(200000); ++k) {
    const double size = std::ldexp(1.0, static_cast<int>(random.below(120)) - 60);
    const glm::dvec3 center = size * random.direction() * 4.0;
    const glm::dvec3 half = size * (glm::dvec3(0.1) + 0.4 * random.in_box(glm::dvec3(0.0), glm::dvec3(1.0)));
    // A triangle with one corner exactly in the box.
    glm::dvec3 inside = center;
    for (int a = 0; a < 3; ++a) {
      const double s = random.between(-1.0, 1.0);
      inside[a] += (random.below(2) != 0 ? (s > 0 ? 0.999 : -0.999) : s) * half[a];
    }
    const glm::dvec3 b =
        inside + size * random.direction() * std::ldexp(1.0, -static_cast<int>(random.below(30)));
    const glm::dvec3 c = inside + size * random.direction() * 8.0;
    ASSERT_TRUE(accel::overlaps(tests::corners(inside, b, c), center, half));
  }
}

}  // namespace
}  // namespace marti::tests
