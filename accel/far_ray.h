// Rays that start so far away (or run so fast or so slowly) that the rounding of their parameters is no
// longer small against the margin of a structure's cells: the boxes they are tested against are enlarged by
// the ray's own error.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <glm/vec3.hpp>

#include "accel/frame.h"
#include "accel/ray.h"
#include "accel/real.h"

namespace marti::accel {

/// The interval of a ray's parameters inside an enlarged box; empty when in > out. Never NaN.
struct FarSpan {
  double in;
  double out;
};

/// The data of a ray for the slow walk.
struct FarRay {
  std::array<double, 3> origin;
  std::array<double, 3> direction;
  double t_min;
  double margin;  ///< by how much boxes are enlarged: kernel, slab and cell errors together
  double slack;   ///< the margin as a parameter of the ray

  /// `float_kernel`: primitives are intersected in floats. Then a hit may be off by watertight.h's error for
  /// floats, coordinates and origin are rounded, and the cells' own margins are negligible beside that.
  /// `rounding`: how often the kernel's error hits may be off by, 1 or more.
  FarRay(const RootFrame& frame, const Ray& ray, bool float_kernel = false, double rounding = 1.0)
      : origin{ray.origin.x, ray.origin.y, ray.origin.z},
        direction{ray.direction.x, ray.direction.y, ray.direction.z},
        t_min(ray.t_min) {
    const std::array<double, 3> center{frame.center.x, frame.center.y, frame.center.z};
    double reach = frame.far;
    double speed = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      reach = std::max(reach, std::abs(origin[a] - center[a]));
      speed = std::max(speed, std::abs(direction[a]));
    }
    margin = 4.0 * frame.delta + rounding * 32.0 * 0x1p-53 * reach;
    if (float_kernel) {
      double largest = 0.0;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<glm::length_t>(a);
        largest = std::max(
            {largest, std::abs(frame.box.lo[axis]), std::abs(frame.box.hi[axis]), std::abs(origin[a])});
      }
      margin += rounding * 32.0 * RealFormat<float>::spacing * (reach + largest);
    }
    slack = 4.0 * margin / speed;
  }

  /// Whether a hit may lie in a box with this interval that is not beyond the parameter `best`.
  [[nodiscard]] bool may_hit(const FarSpan& span, double best) const {
    return span.in <= span.out && span.out >= t_min - slack && span.in <= best + slack;
  }

  [[nodiscard]] FarSpan span(const glm::dvec3& box_lo, const glm::dvec3& box_hi) const {
    FarSpan span{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (int a = 0; a < 3; ++a) {
      const auto k = static_cast<std::size_t>(a);
      const double lo = box_lo[a] - margin - origin[k];
      const double hi = box_hi[a] + margin - origin[k];
      if (direction[k] == 0.0) {
        if (lo > 0.0 || hi < 0.0) {
          return {1.0, 0.0};
        }
        continue;
      }
      double near = lo / direction[k];
      double far = hi / direction[k];
      if (near > far) {
        std::swap(near, far);
      }
      span.in = std::max(span.in, near);
      span.out = std::min(span.out, far);
    }
    return span;
  }
};

}  // namespace marti::accel
