// Rays that break careless structures, made from seeds: the same on every computer.
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

/// The largest magnitude of a coordinate.
inline double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Classes of rays.
enum class Aim : std::uint8_t {
  random,
  axis,
  cell_face,
  vertex,
  edge,
  corner,
  denormal,
  far,
  inside,
  grazing
};
inline constexpr std::array<Aim, 10> all_aims{Aim::random, Aim::axis,   Aim::cell_face, Aim::vertex,
                                              Aim::edge,   Aim::corner, Aim::denormal,  Aim::far,
                                              Aim::inside, Aim::grazing};

/// Makes rays at a set's triangles; without any, at points of `box` instead. `box` is the root box of the
/// structure whose planes the rays of cell_face and corner are to lie in.
class RayMaker {
 public:
  RayMaker(const accel::TriangleSet& triangles, const scenes::Bounds& box, std::uint64_t seed)
      : triangles_(triangles), box_(box), random_(seed) {}

  accel::Ray make(Aim aim) {
    accel::Ray ray;
    const glm::dvec3 extent = box_.hi - box_.lo;
    const double size = largest(extent);
    ray.origin = random_.in_box(box_.lo - 0.5 * extent, box_.hi + 0.5 * extent);
    switch (aim) {
      case Aim::random:
        ray.direction = aim_at(ray.origin, random_.in_box(box_.lo, box_.hi));
        break;
      case Aim::inside:
        ray.origin = random_.in_box(box_.lo, box_.hi);
        ray.direction = random_.direction();
        break;
      case Aim::axis:
        ray.origin = on_planes(ray.origin, random_.below(8));
        ray.direction = axis_direction();
        break;
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
        const auto [a, b, c] = triangle();
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
      case Aim::grazing: {  // in a triangle's plane, but for rounding
        const auto [a, b, c] = triangle();
        ray.origin = a + random_.between(-4.0, 4.0) * (b - a) + random_.between(-4.0, 4.0) * (c - a);
        ray.direction =
            aim_at(ray.origin, a + 0.5 * random_.unit() * (b - a) + 0.5 * random_.unit() * (c - a));
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
  /// The corners of a triangle, beginning with any of them.
  std::array<glm::dvec3, 3> triangle() {
    std::array<glm::dvec3, 3> corners;
    const std::uint32_t id = triangles_.triangles() == 0 ? 0 : random_.below(triangles_.triangles());
    const unsigned first = random_.below(3);
    for (unsigned k = 0; k < 3; ++k) {
      corners[k] = triangles_.triangles() == 0 ? random_.in_box(box_.lo, box_.hi)
                                               : triangles_.corner(id, (first + k) % 3);
    }
    return corners;
  }
  glm::dvec3 vertex() {
    if (triangles_.triangles() == 0) {
      return random_.in_box(box_.lo, box_.hi);
    }
    const unsigned corner = random_.below(3);
    return triangles_.corner(random_.below(triangles_.triangles()), corner);
  }
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
