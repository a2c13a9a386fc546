// Whether a triangle meets an axis-aligned box. Both are closed: touching counts.
//
// Separating axes (Akenine-Moller, "Fast 3D Triangle-Box Overlap Testing", JGT 6(1), 2001) in double, with an
// error bound on each axis, so that the answer is never "no" when the exact answer is "yes". The three box
// axes are exact, because rounding is monotone. With u = 2^-53, and m and h the corners' largest distance
// from the box centre and the box's half size on an axis, the projections of an edge axis err by less than 24
// u (m+h)(m+h) of its two axes, those of the triangle's normal by less than 256 u times the product over all
// three. Clipping is no substitute: its rounded intersection points lose touching triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/vec3.hpp>

#include "accel/triangles.h"

namespace marti::accel {

namespace detail {

/// Tests edge i cross axis a; false when it separates triangle and box by more than the error bound.
template <class Real>
inline bool edge_axis_meets(Real e_b, Real e_c, Real h_b, Real h_c, Real v_b, Real v_c, Real w_b, Real w_c,
                            Real bound) {
  using std::abs;
  using std::max;
  using std::min;
  // Both ends of the edge project to the same value, so one of them and the opposite corner suffice.
  const Real p = e_c * v_b - e_b * v_c;
  const Real q = e_c * w_b - e_b * w_c;
  const Real r = h_b * abs(e_c) + h_c * abs(e_b) + bound;
  return min(p, q) <= r && max(p, q) >= -r;
}

}  // namespace detail

/// True when the closed triangle meets the closed box [center - half, center + half]; may also be true when
/// they are apart by no more than the rounding of the test (about 1e-13 of the triangle's size).
/// Real is the scalar the arithmetic is done in (double, or Counted to count it).
template <class Real>
[[nodiscard]] inline bool overlaps(const TriangleCorners& triangle, const std::array<Real, 3>& c,
                                   const std::array<Real, 3>& h) {
  using std::abs;
  using std::max;
  using std::min;
  std::array<std::array<Real, 3>, 3> v{};  // v[corner][axis]
  std::array<Real, 3> reach{};             // m + h
  for (std::size_t a = 0; a < 3; ++a) {
    v[0][a] = Real(triangle[a]) - c[a];
    v[1][a] = Real(triangle[3 + a]) - c[a];
    v[2][a] = Real(triangle[6 + a]) - c[a];
    const Real lo = min(min(v[0][a], v[1][a]), v[2][a]);
    const Real hi = max(max(v[0][a], v[1][a]), v[2][a]);
    if (lo > h[a] || hi < -h[a]) {
      return false;
    }
    reach[a] = max(-lo, hi) + h[a];
  }

  const auto edge = [&v](std::size_t i, std::size_t a) { return v[(i + 1) % 3][a] - v[i][a]; };
  const std::array<Real, 3> e0{edge(0, 0), edge(0, 1), edge(0, 2)};
  const std::array<Real, 3> e1{edge(1, 0), edge(1, 1), edge(1, 2)};

  Real distance = 0.0;
  Real radius = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    const std::size_t d = (a + 2) % 3;
    const Real normal = e0[b] * e1[d] - e0[d] * e1[b];
    distance += normal * v[0][a];
    radius += h[a] * abs(normal);
  }
  if (abs(distance) > radius + Real(256 * 0x1p-53) * (reach[0] * reach[1] * reach[2])) {
    return false;
  }

  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    const std::size_t d = (a + 2) % 3;
    const Real bound = Real(24 * 0x1p-53) * (reach[b] * reach[d]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t opposite = (i + 2) % 3;
      if (!detail::edge_axis_meets<Real>(edge(i, b), edge(i, d), h[b], h[d], v[i][b], v[i][d], v[opposite][b],
                                         v[opposite][d], bound)) {
        return false;
      }
    }
  }
  return true;
}

[[nodiscard]] inline bool overlaps(const TriangleCorners& triangle, const glm::dvec3& center,
                                   const glm::dvec3& half) {
  return overlaps<double>(triangle, {center.x, center.y, center.z}, {half.x, half.y, half.z});
}

}  // namespace marti::accel
