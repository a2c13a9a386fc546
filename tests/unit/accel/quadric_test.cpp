// The kernel for spheres, cylinders and cones against quadratic equations solved in 113 bits, and their
// overlap with boxes against sampled surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "accel/intersect.h"
#include "accel/moved_primitives.h"
#include "accel/primitive_overlap.h"
#include "sim/error.h"
#include "tests/contract/hostile_quadrics.h"
#include "tests/support/long_tests.h"
#include "tests/support/user_error.h"

namespace marti::tests {
namespace {

using accel::Best;
using accel::Hit;
using accel::QuadricShape;
using accel::Ray;
using accel::RaySetup;
using accel::TriangleSet;

__extension__ using Wide = __float128;

Wide root_of(Wide x) {
  Wide y = std::sqrt(static_cast<long double>(x));
  for (int i = 0; i < 2 && y > 0; ++i) {
    y = (y + x / y) / 2;
  }
  return y;
}

struct WideVector {
  Wide x, y, z;
};
WideVector wide(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
WideVector wide(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
Wide dot(const WideVector& a, const WideVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
WideVector at(const WideVector& a, const WideVector& b, Wide s) {
  return {a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

/// The exact hits of a ray on a surface in order, and the distance of the point at a parameter from the
/// surface.
class Oracle {
 public:
  Oracle(const QuadricShape& shape, const Ray& ray) : shape_(shape), direction_(wide(ray.direction)) {
    const WideVector center = wide(shape.center);
    from_ = at(wide(ray.origin), center, -1);
    axis_ = wide(shape.axis);
    const Wide climb = dot(direction_, axis_);
    const Wide height = dot(from_, axis_);
    const WideVector across = at(direction_, axis_, -climb);
    const WideVector radial = at(from_, axis_, -height);
    const Wide growth = climb * shape.slope;
    const Wide radius = shape.radius + height * shape.slope;
    const Wide a = dot(across, across) - growth * growth;
    const Wide b = dot(radial, across) - growth * radius;
    const Wide c = dot(radial, radial) - radius * radius;
    const Wide discriminant = b * b - a * c;
    if (discriminant < 0 || a == 0) {
      return;
    }
    for (const int sign : {-1, 1}) {
      const Wide t = (-b + sign * root_of(discriminant)) / a;
      const Wide h = height + climb * t;
      const bool within = shape.half == 0.0 || (h <= shape.half && -h <= shape.half);
      if (within && t >= ray.t_min && t <= ray.t_max) {
        hits_.push_back(t);
      }
    }
    std::sort(hits_.begin(), hits_.end());
  }

  [[nodiscard]] const std::vector<Wide>& hits() const { return hits_; }

  /// Distance of the point at t from the surface, ends included; an upper bound.
  [[nodiscard]] double distance(double t) const {
    const WideVector p = at(from_, direction_, t);
    const Wide h = dot(p, axis_);
    const WideVector out = at(p, axis_, -h);
    const Wide excess = root_of(dot(out, out)) - (shape_.radius + h * shape_.slope);
    const Wide foot = h + excess * shape_.slope * shape_.cosine * shape_.cosine;
    Wide beyond = 0;
    if (shape_.half > 0.0) {
      const Wide size = foot < 0 ? -foot : foot;
      beyond = size > shape_.half ? (size - shape_.half) / shape_.cosine : Wide(0);
    }
    return std::abs(static_cast<double>(excess)) * shape_.cosine + static_cast<double>(beyond);
  }

  /// The sine of the angle between ray and surface at t.
  [[nodiscard]] double incidence(double t) const {
    const WideVector p = at(from_, direction_, t);
    const WideVector out = at(p, axis_, -dot(p, axis_));
    const Wide climb = dot(direction_, axis_);
    const Wide rate = (dot(out, direction_) - dot(out, axis_) * climb) / root_of(dot(out, out));
    return std::abs(static_cast<double>(rate - climb * shape_.slope)) * shape_.cosine /
           static_cast<double>(root_of(dot(direction_, direction_)));
  }

 private:
  QuadricShape shape_;
  WideVector direction_;
  WideVector from_{};
  WideVector axis_{};
  std::vector<Wide> hits_;
};

Hit test_one(const Ray& ray, const QuadricShape& shape, std::uint32_t id = 0) {
  const RaySetup<double> setup(ray);
  Best<double> best(setup);
  accel::intersect_quadric(setup, shape, id, best);
  return best.hit();
}

TriangleSet set_of_quadrics(const std::vector<scenes::Quadric>& quadrics) {
  return TriangleSet({}, quadrics);
}

double travelled(const QuadricShape& shape, const Ray& ray) {
  return std::abs(shape.center[0] - ray.origin.x) + std::abs(shape.center[1] - ray.origin.y) +
         std::abs(shape.center[2] - ray.origin.z);
}

// The bound of quadric_kernel.h, of every hit of every kind of ray.
TEST(QuadricKernel, AcceptedHitsAreOnTheSurface) {
  for (const double offset : {0.0, 1e3, 1e9}) {
    const TriangleSet set = set_of_quadrics(hostile_quadrics(offset, 51));
    QuadricRayMaker maker(set, 53);
    std::uint64_t hits = 0;
    for (int k = 0; k < test::cases(4000); ++k) {
      const Ray ray = maker.make(all_quadric_aims[static_cast<std::size_t>(k) % all_quadric_aims.size()]);
      for (std::uint32_t id = 0; id < set.size(); id += 3) {
        const QuadricShape& shape = set.quadric(id);
        const Hit hit = test_one(ray, shape);
        if (hit.found()) {
          ++hits;
          const double away = travelled(shape, ray);
          ASSERT_LE(Oracle(shape, ray).distance(hit.t),
                    (0x1p-46 + 13 * 0x1p-53) * shape.reach + 9 * 0x1p-53 * away)
              << "quadric " << id << ", ray " << k;
        }
      }
    }
    EXPECT_GT(hits, test::cases(10000U));
  }
}

// Where the exact answer is not in doubt the kernel gives it: the same root, to the accuracy the bound
// allows.
TEST(QuadricKernel, FindsTheExactRoots) {
  const TriangleSet set = set_of_quadrics(hostile_quadrics(0.0, 57));
  QuadricRayMaker maker(set, 59);
  int agreed = 0;
  int misses = 0;
  int doubtful = 0;
  for (int k = 0; k < test::cases(3000); ++k) {
    const Ray ray = maker.make(all_quadric_aims[static_cast<std::size_t>(k) % all_quadric_aims.size()]);
    for (std::uint32_t id = 0; id < set.size(); id += 3) {
      const QuadricShape& shape = set.quadric(id);
      const Hit hit = test_one(ray, shape);
      // The surface a little larger and a little smaller, the ray's limits as well: where all agree, the
      // exact answer is certain.
      const double doubt = 0x1p-40 * shape.reach + 0x1p-46 * travelled(shape, ray);
      const double speed = glm::length(ray.direction);
      const auto varied = [&](double by) {
        QuadricShape other = shape;
        other.radius += by;
        if (other.half > 0.0) {
          other.half += by;
        }
        Ray limits = ray;
        limits.t_min -= by / speed;
        limits.t_max += by / speed;
        return Oracle(other, limits).hits();
      };
      const std::vector<Wide> exact = varied(0.0);
      const std::vector<Wide> larger = varied(doubt);
      const std::vector<Wide> smaller = varied(-doubt);
      // A ray in the surface crosses none of the three.
      const bool in_surface = hit.found() && Oracle(shape, ray).incidence(hit.t) < 0x1p-20;
      if (larger.size() != exact.size() || smaller.size() != exact.size() || shape.radius <= 8 * doubt ||
          in_surface) {
        ++doubtful;
        continue;
      }
      if (exact.empty()) {
        ASSERT_FALSE(hit.found()) << "quadric " << id << ", ray " << k;
        ++misses;
        continue;
      }
      ASSERT_TRUE(hit.found()) << "quadric " << id << ", ray " << k;
      const double spread = static_cast<double>(
          std::max(larger[0] > smaller[0] ? larger[0] - smaller[0] : smaller[0] - larger[0], Wide(0)));
      ASSERT_LE(std::abs(static_cast<double>(exact[0] - hit.t)), spread + 4 * doubt / speed)
          << "quadric " << id << ", ray " << k;
      ++agreed;
    }
  }
  EXPECT_GT(agreed, test::cases(8000));
  EXPECT_GT(misses, test::cases(50000));
  EXPECT_LT(doubtful, test::cases(20000));
}

TEST(QuadricKernel, GivesTheParameter) {
  const TriangleSet set = set_of_quadrics(
      {sphere({0, 0, 5}, 2), cylinder({0, -1, 5}, {0, 1, 5}, 2), cone({0, -1, 5}, {0, 1, 5}, 4, 0)});
  for (std::uint32_t id = 0; id < set.size(); ++id) {
    for (const double length : {1.0, 0.25}) {
      Ray ray{{0, 0, 0}, {0, 0, length}};
      EXPECT_EQ(test_one(ray, set.quadric(id)).t, 3.0 / length);
      ray.t_min = 4.0 / length;  // from inside
      EXPECT_EQ(test_one(ray, set.quadric(id)).t, 7.0 / length);
      ray = {{0, 0, 10}, {0, 0, -length}};
      EXPECT_EQ(test_one(ray, set.quadric(id)).t, 3.0 / length);
    }
    EXPECT_FALSE(test_one({{0, 0, 0}, {0, 0, -1}}, set.quadric(id)).found());
    EXPECT_FALSE(test_one({{4.5, 0, 0}, {0, 0, 1}}, set.quadric(id)).found());
  }
  // Cylinders and cones are open at their ends.
  EXPECT_TRUE(test_one({{0.5, -9, 5}, {0, 1, 0}}, set.quadric(0)).found());
  EXPECT_FALSE(test_one({{0.5, -9, 5}, {0, 1, 0}}, set.quadric(1)).found());
  EXPECT_EQ(test_one({{0, -9, 7}, {0, 1, 0}}, set.quadric(2)).t, 9.0) << "through the open base, from inside";
}

TEST(QuadricKernel, BothLimitsAreInclusiveAndTiesGoToTheLowestId) {
  const TriangleSet set = set_of_quadrics({sphere({0, 0, 5}, 2), cylinder({0, -1, 5}, {0, 1, 5}, 2)});
  for (std::uint32_t id = 0; id < set.size(); ++id) {
    Ray ray{{0, 0, 0}, {0, 0, 1}};
    ray.t_max = 3.0;
    EXPECT_TRUE(test_one(ray, set.quadric(id)).found());
    ray.t_max = std::nextafter(3.0, 0.0);
    EXPECT_FALSE(test_one(ray, set.quadric(id)).found());
    ray.t_max = 5.0;
    ray.t_min = std::nextafter(3.0, 5.0);
    EXPECT_FALSE(test_one(ray, set.quadric(id)).found());
  }
  const RaySetup<double> setup({{0, 0, 0}, {0, 0, 1}});
  for (const std::array<std::uint32_t, 2>& order : {std::array<std::uint32_t, 2>{0, 1}, {1, 0}}) {
    Best<double> best(setup);
    for (const std::uint32_t id : order) {
      accel::intersect_quadric(setup, set.quadric(id), id, best);
    }
    EXPECT_EQ(best.primitive, 0U);
  }
}

// Never "no" for a box with a point of the surface in it, and seldom "yes" for one without.
TEST(QuadricOverlap, ListsEveryBoxWithAPointOfTheSurface) {
  constexpr int cells = 32;
  Random random(61);
  std::uint64_t exact = 0;
  std::uint64_t listed = 0;
  std::uint64_t in_bounds = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const glm::dvec3 base = random.in_box(glm::dvec3(-0.5), glm::dvec3(0.5));
    const glm::dvec3 tip = base + random.between(0.1, 0.8) * random.direction();
    const double radius = random.between(0.02, 0.4);
    scenes::Quadric quadric = sphere(base, radius);
    if (trial % 3 == 1) {
      quadric = cylinder(base, tip, radius);
    } else if (trial % 3 == 2) {
      quadric = cone(base, tip, radius, trial % 2 == 0 ? 0.0 : random.between(0.0, 0.4));
    }
    const TriangleSet set = set_of_quadrics({quadric});
    const QuadricShape& shape = set.quadric(0);
    // A grid from (-1.4, -1.4, -1.4) on, its cells not cubes.
    const glm::dvec3 cell = glm::dvec3(2.8, 2.4, 2.6) / static_cast<double>(cells);
    std::vector<std::uint8_t> sampled(cells * cells * cells, 0);
    const glm::dvec3 axis(shape.axis[0], shape.axis[1], shape.axis[2]);
    const glm::dvec3 center(shape.center[0], shape.center[1], shape.center[2]);
    const glm::dvec3 right =
        shape.half > 0.0 ? glm::normalize(glm::cross(
                               axis, std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)))
                         : glm::dvec3(1, 0, 0);
    const glm::dvec3 up = shape.half > 0.0 ? glm::cross(axis, right) : glm::dvec3(0, 1, 0);
    constexpr int steps = 300;
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        const double angle = 2.0 * 3.141592653589793 * j / steps;
        const glm::dvec3 around = std::cos(angle) * right + std::sin(angle) * up;
        const double v = 2.0 * i / steps - 1.0;
        const glm::dvec3 p =
            shape.half > 0.0
                ? center + v * shape.half * axis + (shape.radius + shape.slope * v * shape.half) * around
                : center + shape.radius * (std::sqrt(1.0 - v * v) * around + v * glm::dvec3(0, 0, 1));
        const glm::ivec3 at(glm::dvec3((p + 1.4) / cell));
        if (std::min({at.x, at.y, at.z}) >= 0 && std::max({at.x, at.y, at.z}) < cells) {
          sampled[static_cast<std::size_t>((at.z * cells + at.y) * cells + at.x)] = 1;
        }
      }
    }
    for (int z = 0; z < cells; ++z) {
      for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
          const glm::dvec3 middle = (glm::dvec3(x, y, z) + 0.5) * cell - 1.4;
          const bool meets = sampled[static_cast<std::size_t>((z * cells + y) * cells + x)] != 0;
          const bool lists = accel::overlaps(set, 0, middle, 0.5 * cell + 1e-12);
          ASSERT_TRUE(lists || !meets) << "trial " << trial;
          exact += meets ? 1U : 0U;
          listed += lists ? 1U : 0U;
          bool near = true;
          for (int a = 0; a < 3; ++a) {
            const auto k = static_cast<std::size_t>(a);
            near =
                near && shape.lo[k] <= middle[a] + 0.5 * cell[a] && shape.hi[k] >= middle[a] - 0.5 * cell[a];
          }
          in_bounds += near ? 1U : 0U;
        }
      }
    }
  }
  RecordProperty("exact", static_cast<int>(exact));
  RecordProperty("listed", static_cast<int>(listed));
  EXPECT_GT(exact, 10000U);
  EXPECT_LT(static_cast<double>(listed), 1.10 * static_cast<double>(exact)) << in_bounds << " in the bounds";
}

// Boxes that only touch: on every side of a sphere, and a cylinder in a face of the box.
TEST(QuadricOverlap, TouchingCounts) {
  const TriangleSet set = set_of_quadrics({sphere({0, 0, 0}, 1), cylinder({0, 0, -1}, {0, 0, 1}, 1)});
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(accel::overlaps(set, 0, {side * 1.5, 0, 0}, {0.5, 0.5, 0.5}));
    EXPECT_FALSE(accel::overlaps(set, 0, {side * 1.501, 0, 0}, {0.5, 0.5, 0.5}));
    EXPECT_TRUE(accel::overlaps(set, 1, {side * 1.5, 0, 0}, {0.5, 0.5, 0.5}));
    EXPECT_TRUE(accel::overlaps(set, 1, {1, 0, side * 1.5}, {0.5, 0.5, 0.5}));
    EXPECT_FALSE(accel::overlaps(set, 1, {1, 0, side * 1.501}, {0.5, 0.5, 0.5}));
  }
  EXPECT_FALSE(accel::overlaps(set, 0, {0, 0, 0}, {0.5, 0.5, 0.5})) << "inside";
  EXPECT_FALSE(accel::overlaps(set, 1, {0, 0, 0.9}, {0.5, 0.5, 0.5})) << "inside and out at an open end";
  EXPECT_TRUE(accel::overlaps(set, 0, {0, 0, 0}, {1, 1, 1}));
}

TEST(Quadrics, DegenerateOnesAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const glm::dvec3 a(1, 2, 3);
  const glm::dvec3 b(2, 2, 3);
  for (const scenes::Quadric& quadric :
       {sphere(a, 0), sphere(a, -1), sphere(a, nan), sphere(a, inf), sphere(a, 1e-200),
        sphere({nan, 0, 0}, 1), sphere({0, 1e100, 0}, 1), cylinder(a, a, 1), cylinder(a, b, 0),
        cylinder(a, {0, inf, 0}, 1), cylinder(a, a + glm::dvec3(1e-9, 0, 0), 1), cylinder(a, b, 1e-13),
        cone(a, b, 0, 0), cone(a, b, 1, -1), cone(a, b, -1, 1), cone(a, b, nan, 1), cone(a, a, 1, 0),
        cone(a, a + glm::dvec3(0, 1e-9, 0), 1, 0)}) {
    EXPECT_THROW((void)set_of_quadrics({sphere(a, 1), quadric}), sim::UserError);
  }
  const std::string flat = test::user_error_of([&] { (void)set_of_quadrics({sphere(a, 1), sphere(a, 0)}); });
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "cone 1 has no radius", flat);
  EXPECT_NO_THROW((void)set_of_quadrics({sphere(a, 1e-60), cone(a, b, 1, 0), cone(a, b, 0, 1)}));
}

// Moving one primitive of a set is seen by the octree's update, whatever its kind.
TEST(Quadrics, MovedOnesAreFound) {
  const std::vector<accel::TriangleCorners> triangles = tests::hostile_soup(0.0, 71);
  std::vector<scenes::Quadric> quadrics = hostile_quadrics(0.0, 73);
  const TriangleSet before(triangles, quadrics);
  const auto first = static_cast<std::uint32_t>(triangles.size());
  EXPECT_TRUE(accel::moved_primitives(before, TriangleSet(triangles, quadrics)).empty());
  quadrics[3].base.x += 0.001;
  quadrics[45].tip.y += 0.001;
  quadrics[85].radius *= 1.5;
  EXPECT_EQ(accel::moved_primitives(before, TriangleSet(triangles, quadrics)),
            (std::vector<std::uint32_t>{first + 3, first + 45, first + 85}));
  quadrics.pop_back();
  EXPECT_THROW((void)accel::moved_primitives(before, TriangleSet(triangles, quadrics)), sim::UserError);
}

TEST(Quadrics, BoundsAreTight) {
  const scenes::Bounds bounds = scenes::bounds_of(cylinder({0, 0, 0}, {3, 4, 0}, 5));
  EXPECT_NEAR(bounds.lo.x, -4.0, 1e-14);
  EXPECT_NEAR(bounds.hi.x, 7.0, 1e-14);
  EXPECT_NEAR(bounds.lo.y, -3.0, 1e-14);
  EXPECT_NEAR(bounds.hi.y, 7.0, 1e-14);
  EXPECT_NEAR(bounds.lo.z, -5.0, 1e-14);
  EXPECT_NEAR(bounds.hi.z, 5.0, 1e-14);
}

}  // namespace
}  // namespace marti::tests
