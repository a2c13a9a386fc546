// The boxes of a bounding volume hierarchy, in floats, and the coordinates in which they are kept.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <glm/vec3.hpp>

#include "accel/frame.h"
#include "accel/triangles.h"

namespace marti::accel {

/// From the scene's coordinates to those of the boxes: relative to the centre of the root box, and scaled by
/// a power of two so that the root box lies within -1 and 1. So floats are fine enough wherever the scene
/// lies, and never overflow.
struct BvhSpace {
  glm::dvec3 center{0.0};
  double unit = 1.0;     ///< scale, a power of two
  double inverse = 1.0;  ///< 1 / unit

  BvhSpace() = default;
  explicit BvhSpace(const RootFrame& frame) : center(frame.center) {
    double half = 0.0;
    for (int a = 0; a < 3; ++a) {
      half = std::max(half, 0.5 * (frame.box.hi[a] - frame.box.lo[a]));
    }
    if (half > 0.0) {
      const int exponent = std::max(std::ilogb(half) + 1, -1000);
      unit = std::ldexp(1.0, -exponent);
      inverse = std::ldexp(1.0, exponent);
    }
  }
};

/// A box of floats or of scalars that count; of floats there is a fourth lane, which is not used. Bounds are
/// unions of bounds of primitives, without rounding, so they do not depend on the order in which they are
/// united.
template <class Float>
struct alignas(16) BvhBoxOf {
  static constexpr std::size_t lanes = std::is_same_v<Float, float> ? 4 : 3;
  static constexpr float inf = std::numeric_limits<float>::infinity();
  using Point = std::array<Float, 4>;

  Point lo{inf, inf, inf, inf};
  Point hi{-inf, -inf, -inf, -inf};

  void include(const BvhBoxOf& other) {
    for (std::size_t a = 0; a < lanes; ++a) {
      lo[a] = other.lo[a] < lo[a] ? other.lo[a] : lo[a];
      hi[a] = other.hi[a] > hi[a] ? other.hi[a] : hi[a];
    }
  }
  void include(const Point& point) {
    for (std::size_t a = 0; a < lanes; ++a) {
      lo[a] = point[a] < lo[a] ? point[a] : lo[a];
      hi[a] = point[a] > hi[a] ? point[a] : hi[a];
    }
  }
  /// Twice the centre.
  [[nodiscard]] Point centroid() const { return {lo[0] + hi[0], lo[1] + hi[1], lo[2] + hi[2], 0.0F}; }
  /// Half the surface area; 0 for an empty box.
  [[nodiscard]] Float half_area() const {
    const Float x = hi[0] - lo[0];
    const Float y = hi[1] - lo[1];
    const Float z = hi[2] - lo[2];
    return x < 0.0F ? Float(0.0F) : x * y + y * z + z * x;
  }
};
using BvhBox = BvhBoxOf<float>;

/// The box of primitive `id`, rounded outwards. Real: the scalar of the arithmetic, double or Counted.
template <class Real = double>
[[nodiscard]] BvhBox bvh_box_of(const BvhSpace& space, const TriangleSet& triangles, std::uint32_t id);

}  // namespace marti::accel
