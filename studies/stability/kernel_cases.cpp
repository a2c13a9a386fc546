// Cases of the ray/triangle kernel by itself: signs, watertightness, and changes of input that must not
// matter.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

#include <fmt/format.h>

#include "studies/stability/geometry_oracles.h"
#include "studies/stability/kernel_check.h"

namespace marti::studies::stability {

namespace {

using accel::Best;
using accel::Hit;
using accel::Ray;
using accel::RaySetup;
using accel::TriangleCorners;

double edge(double ax, double ay, double bx, double by) { return ax * by - ay * bx; }

/// Calls visit(ax, ay, bx, by) for pairs of vectors that are collinear but for rounding.
template <class Visit>
void near_collinear(std::uint32_t pairs, const Visit& visit) {
  Random random(1);
  for (std::uint32_t k = 0; k < pairs; ++k) {
    const double ax = random.between(-1.0, 1.0);
    const double ay = random.between(-1.0, 1.0);
    const double s = random.between(0.5, 2.0);
    visit(ax, ay, ax * s, ay * s);
  }
}

CaseOutcome edge_signs(const CaseSize& size) {
  Tally tally;
  near_collinear(50 * size.rays, [&](double ax, double ay, double bx, double by) {
    const double e = edge(ax, ay, bx, by);
    tally.add(e == 0.0 || sign(e) == exact_sign(ax, by, ay, bx));
  });
  return none_wrong(tally, "signs wrong");
}

CaseOutcome edge_antisymmetry(const CaseSize& size) {
  Tally tally;
  near_collinear(50 * size.rays, [&](double ax, double ay, double bx, double by) {
    tally.add(edge(ax, ay, bx, by) == -edge(bx, by, ax, ay));
  });
  return none_wrong(tally, "edges seen differently from their two sides");
}

CaseOutcome closed_fans(const CaseSize& size) {
  Random random(5);
  Tally tally;
  for (std::uint32_t trial = 0; trial < size.rays; ++trial) {
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
    tally.add(best.found());
  }
  return none_wrong(tally, "rays through the common corner lost");
}

/// Changes each coordinate of origin, direction and corners.
template <class Change>
Aimed changed(const Aimed& aimed, const Change& change) {
  Aimed other = aimed;
  other.ray.origin = change(aimed.ray.origin, true);
  other.ray.direction = change(aimed.ray.direction, false);
  for (std::size_t c = 0; c < 9; c += 3) {
    const glm::dvec3 p =
        change(glm::dvec3(aimed.triangle[c], aimed.triangle[c + 1], aimed.triangle[c + 2]), true);
    other.triangle[c] = p.x;
    other.triangle[c + 1] = p.y;
    other.triangle[c + 2] = p.z;
  }
  return other;
}

/// Whether `same(aimed, random)` holds of rays and triangles made from the seed; `otherwise` says what went
/// wrong.
template <class Same>
CaseOutcome unchanged(std::uint64_t seed, const CaseSize& size, const Same& same,
                      const char* otherwise = "hits changed") {
  Random random(seed);
  Tally tally;
  for (std::uint32_t k = 0; k < 10 * size.rays; ++k) {
    const Aimed aimed = random_aimed(random);
    tally.add(same(aimed, random));
  }
  return none_wrong(tally, otherwise);
}

CaseOutcome power_of_two(const CaseSize& size) {
  return unchanged(7, size, [](const Aimed& aimed, Random& random) {
    const int exponent = static_cast<int>(random.below(61)) - 30;
    // Only places are scaled, not the direction: t is scaled with them.
    const Aimed scaled = changed(aimed, [&](const glm::dvec3& p, bool place) {
      const int e = place ? exponent : 0;
      return glm::dvec3(std::ldexp(p.x, e), std::ldexp(p.y, e), std::ldexp(p.z, e));
    });
    Hit expected = test_one(aimed.ray, aimed.triangle);
    expected.t = std::ldexp(expected.t, exponent);
    return same_hit(expected, test_one(scaled.ray, scaled.triangle));
  });
}

CaseOutcome turned_axes(const CaseSize& size) {
  return unchanged(8, size, [](const Aimed& aimed, Random& /*random*/) {
    const Aimed turned = changed(aimed, [](const glm::dvec3& p, bool) { return glm::dvec3(p.z, p.x, p.y); });
    return same_hit(test_one(aimed.ray, aimed.triangle), test_one(turned.ray, turned.triangle));
  });
}

CaseOutcome mirrored(const CaseSize& size) {
  return unchanged(9, size, [](const Aimed& aimed, Random& random) {
    const auto axis = static_cast<int>(random.below(3));
    const Aimed other = changed(aimed, [axis](glm::dvec3 p, bool) {
      p[axis] = -p[axis];
      return p;
    });
    return same_hit(test_one(aimed.ray, aimed.triangle), test_one(other.ray, other.triangle));
  });
}

CaseOutcome corner_order(const CaseSize& size) {
  const auto same = [](const Aimed& aimed, Random& /*random*/) {
    const TriangleCorners& t = aimed.triangle;
    const bool hit = test_one(aimed.ray, t).found();
    const TriangleCorners rotated{t[3], t[4], t[5], t[6], t[7], t[8], t[0], t[1], t[2]};
    const TriangleCorners reversed{t[6], t[7], t[8], t[3], t[4], t[5], t[0], t[1], t[2]};
    return test_one(aimed.ray, rotated).found() == hit && test_one(aimed.ray, reversed).found() == hit;
  };
  return unchanged(10, size, same, "hits appeared or vanished");
}

CaseOutcome degenerate_triangles(const CaseSize& size) {
  Random random(3);
  Tally tally;
  for (std::uint32_t k = 0; k < size.rays; ++k) {
    // Whole coordinates and a ray along an axis: all sheared corners are exact, and so is the answer.
    const glm::dvec3 a(random.below(8), random.below(8), random.below(8));
    const glm::dvec3 step(random.below(3), random.below(3), random.below(3));
    const Ray ray{a - glm::dvec3(0, 0, 9), {0, 0, 1}};
    tally.add(!test_one(ray, corners(a, a + step, a + 2.0 * step)).found() &&
              !test_one(ray, corners(a, a, a)).found());
  }
  return none_wrong(tally, "hit");
}

/// Corners d, -d and 0 lie on a line exactly, whatever d is; once sheared and rounded they do not.
CaseOutcome collinear_triangles(const CaseSize& size) {
  Random random(3);
  Tally tally;
  for (std::uint32_t k = 0; k < size.rays; ++k) {
    const glm::dvec3 d = random.direction();
    const glm::dvec3 toward = random.direction();
    const accel::TriangleSet set(std::vector<TriangleCorners>{corners(d, -d, glm::dvec3(0.0))});
    tally.add(!test_one({-4.0 * toward, toward}, set[0]).found());
  }
  return none_wrong(tally, "hit");
}

/// A closed mesh at some place, traced through every structure.
struct LeakPlace {
  const char* id;
  double offset;
  double size;
  const char* where;
};

CaseOutcome closed_mesh(const LeakPlace& place, const CaseSize& size) {
  const PlacedSphere mesh(4, place.offset, place.size);
  const auto triangles = std::make_shared<const accel::TriangleSet>(mesh.triangles);
  Tally tally;
  for (const auto& structure : build_structures(triangles, false)) {
    tally += leaks(
        mesh, [&](const Ray& ray) { return structure->occluded(ray) ? structure->closest(ray) : Hit{}; },
        size.rays, 41);
  }
  return none_wrong(tally, "rays leaked");
}

CaseOutcome closed_mesh_in_floats(const CaseSize& size) {
  const PlacedSphere mesh(3, 0.0, 1.0);
  const auto triangles = std::make_shared<const accel::TriangleSet>(mesh.triangles);
  const accel::Octree octree = accel::Octree::build(triangles);
  return none_wrong(leaks(
                        mesh,
                        [&](const Ray& ray) {
                          accel::NullVisitor visitor;
                          return octree.closest<float>(ray, visitor);
                        },
                        size.rays, 43),
                    "rays leaked");
}

}  // namespace

void add_kernel_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::geometry);
  add("edge-signs", "products contracted to fused multiply-adds give edge functions wrong signs",
      "sign by two-products, exact", edge_signs);
  add("edge-antisymmetry", "two triangles see their common edge differently",
      "E(a, b) = -E(b, a), bit for bit", edge_antisymmetry);
  add("closed-fan", "a ray through the common corner of 3 to 64 triangles passes between them",
      "at least one is hit", closed_fans);
  add("degenerate-hit", "a triangle without area is hit by rounding", "none is hit", degenerate_triangles);
  add("collinear-hit", "a triangle of three corners on an oblique line is hit by rounding", "none is hit",
      collinear_triangles);
  add("scale-by-two", "hits depend on the unit of length",
      "all places times 2^k, k to +-30: same hits, t times 2^k", power_of_two);
  add("turned-axes", "hits depend on which axis is which", "x, y, z to y, z, x: same hits, bit for bit",
      turned_axes);
  add("mirrored", "hits depend on the side", "an axis mirrored: same hits, bit for bit", mirrored);
  add("corner-order", "hits depend on the order of a triangle's corners",
      "rotated and reversed: hit or not alike", corner_order);
  for (const LeakPlace& place :
       {LeakPlace{"leaks-at-origin", 0.0, 1.0, "at the origin"},
        LeakPlace{"leaks-at-1e3", 1e3, 1.0, "at 1e3"}, LeakPlace{"leaks-at-1e6", 1e6, 1.0, "at 1e6"},
        LeakPlace{"leaks-at-1e9", 1e9, 1.0, "at 1e9"},
        LeakPlace{"leaks-small", 1e-15, 1e-18, "of size 1e-18"},
        LeakPlace{"leaks-large", 0.0, 1e18, "of size 1e18"}}) {
    add(place.id, fmt::format("rays at corners and edges leak out of a closed mesh {}", place.where),
        "every ray from inside hits, in every structure",
        [place](const CaseSize& size) { return closed_mesh(place, size); });
  }
  add("leaks-in-floats", "the same mesh leaks when hits are computed in floats", "every ray from inside hits",
      closed_mesh_in_floats);
}

}  // namespace marti::studies::stability
