// Spheres, cylinders and cones that break careless kernels and structures, and rays at them.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "accel/ray.h"
#include "accel/triangles.h"
#include "scenes/quadric.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"

namespace marti::tests {

inline scenes::Quadric sphere(const glm::dvec3& center, double radius) {
  return {.kind = scenes::QuadricKind::sphere, .base = center, .radius = radius};
}
inline scenes::Quadric cylinder(const glm::dvec3& base, const glm::dvec3& tip, double radius) {
  return {.kind = scenes::QuadricKind::cylinder, .base = base, .tip = tip, .radius = radius};
}
inline scenes::Quadric cone(const glm::dvec3& base, const glm::dvec3& tip, double radius, double tip_radius) {
  return {.kind = scenes::QuadricKind::cone,
          .base = base,
          .tip = tip,
          .radius = radius,
          .tip_radius = tip_radius};
}

/// About 190 quadrics in the cube [-1, 1]^3 moved by `offset`: of all sizes, coincident, concentric,
/// touching, along the axes and in the mid-planes, needles, discs, full and truncated cones; with `huge` also
/// some far larger than the cube.
inline std::vector<scenes::Quadric> hostile_quadrics(double offset, std::uint64_t seed, bool huge = false) {
  Random random(seed);
  const glm::dvec3 o(offset);
  const glm::dvec3 lo(-0.7);
  const glm::dvec3 hi(0.7);
  std::vector<scenes::Quadric> soup;
  const auto place = [&] { return o + random.in_box(lo, hi); };
  const auto size = [&] { return 0.25 * std::ldexp(1.0, -static_cast<int>(random.below(30))); };
  for (int i = 0; i < 40; ++i) {
    soup.push_back(sphere(place(), i < 20 ? random.between(0.02, 0.25) : size()));
  }
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 base = place();
    const double height = size();
    soup.push_back(i % 2 == 0 ? cylinder(base, place(), i % 3 == 0 ? size() : random.between(0.01, 0.1))
                              : cylinder(base, base + height * random.direction(),
                                         height * std::ldexp(1.0, static_cast<int>(random.below(24)) - 12)));
  }
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 base = place();
    soup.push_back(cone(base, base + random.between(0.05, 0.6) * random.direction(),
                        i % 4 == 0 ? 0.0 : random.between(0.01, 0.3),
                        i % 4 == 1 ? 0.0 : random.between(0.01, 0.3)));
  }
  for (int axis = 0; axis < 3; ++axis) {  // along the axes and in the middle of everything
    glm::dvec3 along(0.0);
    along[axis] = 0.5;
    soup.push_back(cylinder(o - along, o + along, 0.125));
    soup.push_back(cone(o - along, o + along, 0.25, 0.0));
    soup.push_back(
        cone(o + 0.5 * along, o + 0.5 * along + std::ldexp(1.0, -12) * random.direction(), 0.1, 0.3));
    soup.push_back(sphere(o + along, 0.25));
  }
  for (int i = 0; i < 6; ++i) {  // concentric, the largest touching the cube's faces
    soup.push_back(sphere(o, 1.0 - 0.125 * i));
  }
  const glm::dvec3 p = place();
  const glm::dvec3 q = place();
  for (int i = 0; i < 12; ++i) {  // coincident; the two ends change places
    soup.push_back(sphere(p, 0.2));
    soup.push_back(cylinder(p, q, 0.1));
    soup.push_back(i % 2 == 0 ? cone(p, q, 0.2, 0.05) : cone(q, p, 0.05, 0.2));
  }
  for (int i = 0; i < 8; ++i) {  // needles
    soup.push_back(cylinder(place(), place(), std::ldexp(1.0, -12 - 3 * i)));
    soup.push_back(cone(place(), place(), std::ldexp(1.0, -12 - 3 * i), 0.0));
  }
  if (huge) {
    soup.push_back(sphere(o + glm::dvec3(0.0, 0.0, 300.0), 300.5));
    soup.push_back(cylinder(o - glm::dvec3(400.0, 10.0, 1.0), o + glm::dvec3(200.0, 30.0, 0.0), 0.5));
    soup.push_back(cone(o - glm::dvec3(0.0, 90.0, 3.0), o + glm::dvec3(0.0, 60.0, 1.0), 80.0, 0.0));
  }
  // Far from the origin some have shrunk to nothing.
  std::erase_if(soup, [](const scenes::Quadric& quadric) {
    try {
      scenes::check_quadric(quadric, "");
      return false;
    } catch (const sim::UserError&) {
      return true;
    }
  });
  return soup;
}

/// Classes of rays at quadrics.
enum class QuadricAim : std::uint8_t { into, tangent, on_surface, inside, along_axis, rim, generator, far };
inline constexpr std::array<QuadricAim, 8> all_quadric_aims{
    QuadricAim::into,       QuadricAim::tangent, QuadricAim::on_surface, QuadricAim::inside,
    QuadricAim::along_axis, QuadricAim::rim,     QuadricAim::generator,  QuadricAim::far};

/// Makes rays at a set's quadrics, of which it needs one.
class QuadricRayMaker {
 public:
  QuadricRayMaker(const accel::TriangleSet& set, std::uint64_t seed) : set_(set), random_(seed) {}

  accel::Ray make(QuadricAim aim) {
    const accel::QuadricShape& shape =
        set_.quadric(set_.triangles() + random_.below(set_.size() - set_.triangles()));
    const glm::dvec3 extent = set_.bounds().hi - set_.bounds().lo;
    accel::Ray ray;
    ray.origin = random_.in_box(set_.bounds().lo - 0.5 * extent, set_.bounds().hi + 0.5 * extent);
    const Point at = on(shape);
    switch (aim) {
      case QuadricAim::into:
        ray.direction = at.place - ray.origin;
        break;
      case QuadricAim::tangent: {
        // Through a point of the surface, across its normal.
        ray.direction = glm::cross(at.normal, random_.direction());
        ray.origin = at.place - random_.between(-1.0, 3.0) * ray.direction;
        break;
      }
      case QuadricAim::on_surface:
        ray.origin = at.place;
        ray.direction = random_.direction();
        break;
      case QuadricAim::inside:
        ray.origin = center(shape) + 0.5 * random_.unit() * (at.place - center(shape));
        ray.direction = random_.below(2) != 0 ? random_.direction() : at.place - ray.origin;
        break;
      case QuadricAim::along_axis: {
        const glm::dvec3 axis = shape.half > 0.0 ? axis_of(shape) : glm::dvec3(0.0, 0.0, 1.0);
        ray.origin = at.place - random_.between(-1.0, 2.0) * axis;
        ray.direction = random_.below(2) != 0 ? axis : -axis;
        if (random_.below(2) != 0) {
          ray.direction += std::ldexp(1.0, -static_cast<int>(random_.below(50))) * random_.direction();
        }
        break;
      }
      case QuadricAim::rim:
        ray.direction = on(shape, random_.below(2) != 0 ? -1.0 : 1.0).place - ray.origin;
        break;
      case QuadricAim::generator:  // along the surface itself
        ray.origin = on(shape, -1.0).place;
        ray.direction = on(shape, 1.0).place - ray.origin;
        break;
      case QuadricAim::far: {
        const double distance = std::pow(10.0, random_.between(2.0, 9.0));
        ray.origin = center(shape) + distance * glm::length(extent) * random_.direction();
        ray.direction = at.place - ray.origin;
        break;
      }
    }
    if (!(glm::length(ray.direction) > 0.0)) {
      ray.direction = random_.direction();
    }
    if (random_.below(4) == 0) {
      ray.direction *= std::ldexp(1.0, static_cast<int>(random_.below(80)) - 40);
    }
    if (random_.below(6) == 0) {
      ray.t_max = 2.0 * random_.unit();
    } else if (random_.below(6) == 0) {
      ray.t_min = random_.between(-2.0, 2.0);
    }
    return ray;
  }

 private:
  struct Point {
    glm::dvec3 place;
    glm::dvec3 normal;
  };
  static glm::dvec3 center(const accel::QuadricShape& s) { return {s.center[0], s.center[1], s.center[2]}; }
  static glm::dvec3 axis_of(const accel::QuadricShape& s) { return {s.axis[0], s.axis[1], s.axis[2]}; }
  /// A point of the surface; `end` -1 or 1 asks for one of a cone's ends.
  Point on(const accel::QuadricShape& shape, double end = 0.0) {
    const glm::dvec3 direction = random_.direction();
    if (shape.half == 0.0) {
      return {center(shape) + shape.radius * direction, direction};
    }
    const glm::dvec3 axis = axis_of(shape);
    const glm::dvec3 out = glm::normalize(glm::cross(axis, direction));
    const double h = shape.half * (end != 0.0 ? end : random_.between(-1.0, 1.0));
    return {center(shape) + h * axis + (shape.radius + shape.slope * h) * out,
            glm::normalize(out - shape.slope * axis)};
  }

  const accel::TriangleSet& set_;
  Random random_;
};

}  // namespace marti::tests
