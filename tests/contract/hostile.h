// Triangles that break careless structures, made from seeds, and the stability study's rays at them.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "accel/triangles.h"
#include "studies/stability/hostile_rays.h"

namespace marti::tests {

using studies::stability::Aim;
using studies::stability::all_aims;
using studies::stability::Random;
using studies::stability::RayMaker;

inline accel::TriangleCorners corners(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
}

/// About 310 triangles in the cube [-1, 1]^3 moved by `offset`: random ones, needles, a fan, a coplanar
/// sheet, triangles in the mid-planes and in the faces of the cube, coincident ones, tiny ones and degenerate
/// ones; with `huge` also two far larger than the cube, so that all the rest crowds into a few cells.
inline std::vector<accel::TriangleCorners> hostile_soup(double offset, std::uint64_t seed,
                                                        bool huge = false) {
  Random random(seed);
  const glm::dvec3 o(offset);
  const glm::dvec3 lo(-0.75);
  const glm::dvec3 hi(0.75);
  std::vector<accel::TriangleCorners> soup;
  const auto add = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    soup.push_back(corners(o + a, o + b, o + c));
  };
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 a = random.in_box(lo, hi);
    add(a, a + 0.2 * random.direction(), a + 0.2 * random.direction());
  }
  for (int i = 0; i < 60; ++i) {  // needles
    const glm::dvec3 a = random.in_box(lo, hi);
    const glm::dvec3 b = random.in_box(lo, hi);
    add(a, b, b + std::ldexp(1.0, -static_cast<int>(random.below(50))) * random.direction());
  }
  const glm::dvec3 apex = 0.5 * random.in_box(lo, hi);
  for (int i = 0; i < 24; ++i) {  // closed fan
    const double s = 0.2617993877991494;
    add(apex, apex + 0.5 * glm::dvec3(std::cos(i * s), std::sin(i * s), 0.3),
        apex + 0.5 * glm::dvec3(std::cos((i + 1) % 24 * s), std::sin((i + 1) % 24 * s), 0.3));
  }
  for (int i = 0; i < 5; ++i) {  // coplanar sheet, its lines on cell planes
    for (int j = 0; j < 5; ++j) {
      const glm::dvec3 p(0.25 * i - 0.75, 0.25 * j - 0.75, 0.25);
      add(p, p + glm::dvec3(0.25, 0, 0), p + glm::dvec3(0.25, 0.25, 0));
      add(p + glm::dvec3(0.25, 0.25, 0), p + glm::dvec3(0, 0.25, 0), p);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {  // in the middle of everything
    glm::dvec3 a(-0.7);
    glm::dvec3 b(0.6);
    glm::dvec3 c(0.1, 0.5, -0.4);
    a[axis] = b[axis] = c[axis] = 0.0;
    add(a, b, c);
  }
  const glm::dvec3 p = random.in_box(lo, hi);
  const glm::dvec3 q = random.in_box(lo, hi);
  const glm::dvec3 r = random.in_box(lo, hi);
  for (int i = 0; i < 30; ++i) {  // coincident
    add(p, q, r);
  }
  add({-1, -1, -1}, {1, -1, -1}, {1, 1, -1});  // faces and corners of the cube
  add({1, 1, -1}, {-1, 1, -1}, {-1, -1, -1});
  add({1, 1, 1}, {1, 0, 1}, {0, 1, 1});
  if (huge) {
    add({-40, -30, -0.9}, {50, -20, -0.9}, {0, 60, -0.91});
    add({-400, 0.3, -300}, {0.5, 0.3, 600}, {500, 0.3, -200});
  }
  for (int i = 0; i < 40; ++i) {  // tiny
    const double size = std::ldexp(1.0, -8 - static_cast<int>(random.below(30)));
    const glm::dvec3 a = random.in_box(lo, hi);
    add(a, a + size * random.direction(), a + size * random.direction());
  }
  add(p, p, p);  // degenerate
  add(p, q, p);
  add({0, 0, 0}, {0.25, 0.25, 0.25}, {0.5, 0.5, 0.5});
  return soup;
}

}  // namespace marti::tests
