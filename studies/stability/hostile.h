// Triangles and rays that break careless structures. Everything is made from seeds, the same on every
// machine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "accel/ray.h"
#include "accel/triangles.h"

namespace marti::studies::stability {

/// Uniform doubles without the library's distributions, whose results differ between implementations.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }
  glm::dvec3 in_box(const glm::dvec3& lo, const glm::dvec3& hi) {
    const double x = between(lo.x, hi.x);
    const double y = between(lo.y, hi.y);
    const double z = between(lo.z, hi.z);
    return {x, y, z};
  }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 d = in_box(glm::dvec3(-1.0), glm::dvec3(1.0));
      const double n = glm::dot(d, d);
      if (n > 0.01 && n < 1.0) {
        return d / std::sqrt(n);
      }
    }
  }

 private:
  std::mt19937_64 engine_;
};

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

/// Classes of rays.
enum class Aim : std::uint8_t { random, axis, cell_face, vertex, edge, corner, denormal, far, inside };
inline constexpr std::array<Aim, 9> all_aims{Aim::random,   Aim::axis, Aim::cell_face,
                                             Aim::vertex,   Aim::edge, Aim::corner,
                                             Aim::denormal, Aim::far,  Aim::inside};

/// Makes rays at a set's triangles, of which it needs one. `box` is the root box of the structure whose
/// planes the rays of cell_face and corner are to lie in.
class RayMaker {
 public:
  RayMaker(const accel::TriangleSet& triangles, const scenes::Bounds& box, std::uint64_t seed)
      : triangles_(triangles), box_(box), random_(seed) {}

  accel::Ray make(Aim aim) {
    accel::Ray ray;
    const glm::dvec3 extent = box_.hi - box_.lo;
    const double size = std::max({extent.x, extent.y, extent.z});
    ray.origin = random_.in_box(box_.lo - 0.5 * extent, box_.hi + 0.5 * extent);
    switch (aim) {
      case Aim::random:
        ray.direction = aim_at(ray.origin, random_.in_box(box_.lo, box_.hi));
        break;
      case Aim::inside:
        ray.origin = random_.in_box(box_.lo, box_.hi);
        ray.direction = random_.direction();
        break;
      case Aim::axis: {
        ray.origin = on_planes(ray.origin, random_.below(8));
        ray.direction = axis_direction();
        break;
      }
      case Aim::cell_face: {
        const std::uint32_t axis = random_.below(3);
        ray.origin = on_planes(ray.origin, 1U << axis);
        ray.direction = random_.direction();
        ray.direction[static_cast<int>(axis)] = random_.below(2) != 0 ? 0.0 : -0.0;
        break;
      }
      case Aim::vertex:
        ray.direction = aim_at(ray.origin, vertex());
        break;
      case Aim::edge: {
        const std::uint32_t id = random_.below(triangles_.triangles());
        const unsigned k = random_.below(3);
        const glm::dvec3 a = triangles_.corner(id, k);
        const glm::dvec3 b = triangles_.corner(id, (k + 1) % 3);
        ray.direction = aim_at(ray.origin, a + random_.unit() * (b - a));
        break;
      }
      case Aim::corner: {
        const glm::dvec3 corner = on_planes(random_.in_box(box_.lo, box_.hi), 7U);
        if (random_.below(2) != 0) {
          ray.origin = corner;
          ray.direction = random_.below(2) != 0 ? random_.direction() : vertex() - corner;
        } else {
          ray.direction = aim_at(ray.origin, corner);
        }
        break;
      }
      case Aim::denormal: {
        ray.origin = random_.below(2) != 0 ? vertex() : ray.origin;
        ray.direction = axis_direction();
        for (int a = 0; a < 3; ++a) {
          if (ray.direction[a] == 0.0) {
            const double tiny = std::ldexp(1.0, -1074 + static_cast<int>(random_.below(120)));
            ray.direction[a] = random_.below(3) == 0 ? -0.0 : (random_.below(2) != 0 ? tiny : -tiny);
          }
        }
        if (random_.below(4) == 0) {
          ray.direction *= std::ldexp(1.0, static_cast<int>(random_.below(1600)) - 900);
        }
        break;
      }
      case Aim::far: {
        const double distance = std::pow(10.0, random_.between(2.0, 9.0));
        ray.origin = 0.5 * (box_.lo + box_.hi) + distance * size * random_.direction();
        ray.direction =
            aim_at(ray.origin, random_.below(2) != 0 ? vertex() : random_.in_box(box_.lo, box_.hi));
        break;
      }
    }
    if (ray.direction == glm::dvec3(0.0)) {
      ray.direction = random_.direction();
    }
    limit(ray);
    return ray;
  }

 private:
  /// Half of the directions are not of unit length.
  glm::dvec3 aim_at(const glm::dvec3& from, const glm::dvec3& at) {
    const glm::dvec3 d = at - from;
    return random_.below(2) != 0 ? d : d * (1.0 / std::sqrt(std::max(glm::dot(d, d), 1e-300)));
  }
  glm::dvec3 vertex() { return triangles_.corner(random_.below(triangles_.triangles()), random_.below(3)); }
  glm::dvec3 axis_direction() {
    glm::dvec3 d(random_.below(2) != 0 ? 0.0 : -0.0, random_.below(2) != 0 ? 0.0 : -0.0,
                 random_.below(2) != 0 ? 0.0 : -0.0);
    d[static_cast<int>(random_.below(3))] = random_.below(2) != 0 ? 1.0 : -1.0;
    return d;
  }
  /// Moves the point into a plane of the octree on each axis of `axes`.
  glm::dvec3 on_planes(glm::dvec3 point, std::uint32_t axes) {
    for (int a = 0; a < 3; ++a) {
      if (((axes >> static_cast<unsigned>(a)) & 1U) != 0) {
        const std::uint32_t level = random_.below(7);
        const std::uint32_t i = random_.below((1U << level) + 1U);
        point[a] = box_.lo[a] + (box_.hi[a] - box_.lo[a]) * std::ldexp(i, -static_cast<int>(level));
      }
    }
    return point;
  }
  /// A quarter of the rays get a random t_min or t_max.
  void limit(accel::Ray& ray) {
    const double length = std::sqrt(glm::dot(ray.direction, ray.direction));
    const double reach = 2.0 * std::sqrt(glm::dot(box_.hi - box_.lo, box_.hi - box_.lo)) / length;
    switch (random_.below(8)) {
      case 0:
        ray.t_max = random_.unit() * reach;
        break;
      case 1:
        ray.t_min = random_.between(-1.0, 1.0) * reach;
        break;
      default:
        break;
    }
    if (!(ray.t_max > ray.t_min)) {
      ray.t_min = 0.0;
      ray.t_max = std::numeric_limits<double>::infinity();
    }
  }

  const accel::TriangleSet& triangles_;
  scenes::Bounds box_;
  Random random_;
};

}  // namespace marti::studies::stability
