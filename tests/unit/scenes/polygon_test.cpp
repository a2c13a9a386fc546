#include "scenes/polygon.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sim/error.h"

namespace marti::scenes {
namespace {

double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

double outline_area(const std::vector<glm::dvec2>& p) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    sum += area(p[0], p[i], p[i + 1]);
  }
  return sum;
}

void expect_triangulation(const std::vector<glm::dvec2>& polygon) {
  const auto triangles = triangulate(polygon);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    ASSERT_GE(orientation(polygon[a], polygon[b], polygon[c]), 0);
    sum += area(polygon[a], polygon[b], polygon[c]);
  }
  // All parts are counter-clockwise and their areas add up to the polygon's: they cover it once.
  EXPECT_NEAR(sum, outline_area(polygon), 1e-12 * std::abs(sum));
}

TEST(Orientation, IsExactOnIntegers) {
  // Offsets make every rounded product wrong, yet the coordinates themselves are exact.
  EXPECT_TRUE(rc::check("sign agrees with 128-bit integers", [] {
    const auto coordinate = [] { return *rc::gen::inRange<std::int64_t>(-40, 40) + (std::int64_t{1} << 50); };
    const std::int64_t ax = coordinate(), ay = coordinate(), bx = coordinate(), by = coordinate();
    const std::int64_t cx = coordinate(), cy = coordinate();
    const __int128 exact =
        static_cast<__int128>(bx - ax) * (cy - ay) - static_cast<__int128>(by - ay) * (cx - ax);
    const auto d = [](std::int64_t x, std::int64_t y) {
      return glm::dvec2(static_cast<double>(x), static_cast<double>(y));
    };
    RC_ASSERT(orientation(d(ax, ay), d(bx, by), d(cx, cy)) == (exact > 0 ? 1 : exact < 0 ? -1 : 0));
  }));
}

TEST(Orientation, SeesOneUlp) {
  const glm::dvec2 a(0.1, 0.1);
  const glm::dvec2 b(0.3, 0.3);
  for (const double x : {0.2, 0.7, 1e5, 1e-7}) {
    EXPECT_EQ(orientation(a, b, {x, x}), 0);
    EXPECT_EQ(orientation(a, b, {x, std::nextafter(x, 1e9)}), 1);
    EXPECT_EQ(orientation(a, b, {x, std::nextafter(x, -1e9)}), -1);
  }
}

TEST(Triangulate, StarsOfAnyShape) {
  EXPECT_TRUE(rc::check("star-shaped polygons", [] {
    const int corners = *rc::gen::inRange(3, 80);
    std::vector<glm::dvec2> polygon;
    for (int i = 0; i < corners; ++i) {
      const double radius = 0.01 + *rc::gen::inRange(0, 1000) / 1000.0;
      const double angle = 2.0 * M_PI * i / corners;
      polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    expect_triangulation(polygon);
  }));
}

TEST(Triangulate, CombsAndSpirals) {
  std::vector<glm::dvec2> comb = {{0, 0}, {40, 0}};
  for (int i = 20; i-- > 0;) {
    comb.emplace_back(2 * i + 2, 10);
    comb.emplace_back(2 * i + 1, 1);
  }
  expect_triangulation(comb);
  std::vector<glm::dvec2> spiral;
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.3 * i;
    spiral.emplace_back((1 + angle) * std::cos(angle), (1 + angle) * std::sin(angle));
  }
  for (int i = 60; i-- > 0;) {
    const double angle = 0.3 * i;
    spiral.emplace_back((0.4 + angle) * std::cos(angle), (0.4 + angle) * std::sin(angle));
  }
  if (outline_area(spiral) < 0.0) {
    std::reverse(spiral.begin(), spiral.end());
  }
  expect_triangulation(spiral);
}

TEST(Triangulate, CollinearCornersStayCorners) {
  expect_triangulation({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}});
}

TEST(Triangulate, RefusesWhatIsNoPolygon) {
  const std::vector<glm::dvec2> two = {{0, 0}, {1, 0}};
  EXPECT_THROW(static_cast<void>(triangulate(two)), sim::UserError);
  const std::vector<glm::dvec2> clockwise = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  EXPECT_THROW(static_cast<void>(triangulate(clockwise)), sim::UserError);
}

}  // namespace
}  // namespace marti::scenes
