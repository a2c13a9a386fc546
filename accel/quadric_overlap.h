// Whether the surface of a sphere, cylinder or cone meets an axis-aligned box. Both are closed: touching
// counts. A box entirely inside the surface does not meet it.
//
// Sphere: the box's nearest and farthest points from the centre, exact up to rounding (Arvo, "A Simple Method
// for Box-Sphere Intersection Testing", Graphics Gems, 1990).
// Cone: the box does not meet the solid cone with flat ends when a direction separates the two. The extents
// of both along any direction have closed forms, so a separation found is a proof, whatever the direction.
// The directions tried are the coordinate axes and those found by projecting a point back and forth between
// box and cone, which converges to the shortest distance between the two (Cheney, Goldstein, "Proximity maps
// for convex sets", Proc. AMS 10, 1959). The box is inside when its corners are, because the solid is convex.
// Listed without need are boxes that do not meet the solid but are not separated after the few directions
// tried, and boxes that meet only the flat ends' middle (there is no surface there).
//
// Rounding: every comparison leaves a slack of 2^-45 of the sum of all distances involved; each value
// compared has fewer than 32 roundings of values below that sum.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "accel/counted.h"
#include "accel/quadric_shape.h"

namespace marti::accel {

namespace detail {

template <class Real>
using Triple = std::array<Real, 3>;

template <class Real>
inline Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A vector's components along an axis of unit length and across it.
template <class Real>
struct Split {
  Real along;
  Triple<Real> across;
  Real distance;  ///< length of `across`

  Split(const Triple<Real>& v, const Triple<Real>& axis) : along(dot(v, axis)) {
    using std::sqrt;
    for (std::size_t a = 0; a < 3; ++a) {
      across[a] = v[a] - axis[a] * along;
    }
    distance = sqrt(dot(across, across));
  }
};

/// A cone against a box, in coordinates relative to the cone's centre.
template <class Real>
class ConeAgainstBox {
 public:
  ConeAgainstBox(const QuadricShape& shape, const Triple<Real>& center, const Triple<Real>& half, Real slack)
      : axis_{Real(shape.axis[0]), Real(shape.axis[1]), Real(shape.axis[2])},
        half_height_(shape.half),
        radius_(shape.radius),
        slope_(shape.slope),
        center_(center),
        half_(half),
        slack_(slack) {}

  /// True when a direction proves that the box does not meet the solid.
  [[nodiscard]] bool apart() const {
    using std::max;
    using std::min;
    if (separates(axis_) || separates({-axis_[0], -axis_[1], -axis_[2]})) {
      return true;
    }
    Triple<Real> point = center_;
    for (int step = 0; step < 4; ++step) {
      const Split<Real> split(point, axis_);
      const Real height = min(max(split.along, -half_height_), half_height_);
      const Real radius = radius_ + slope_ * height;
      const bool beyond_end = !(height == split.along);
      const bool beyond_side = split.distance > radius;
      if (!beyond_end && !beyond_side) {
        return false;  // a point of the box is in the solid
      }
      const Real scale = beyond_side ? radius / split.distance : Real(1.0);
      Triple<Real> nearest;
      Triple<Real> direction;
      for (std::size_t a = 0; a < 3; ++a) {
        nearest[a] = axis_[a] * height + split.across[a] * scale;
        direction[a] =
            beyond_end ? point[a] - nearest[a] : split.across[a] - axis_[a] * (slope_ * split.distance);
      }
      if (separates(direction)) {
        return true;
      }
      for (std::size_t a = 0; a < 3; ++a) {
        point[a] = min(max(nearest[a], center_[a] - half_[a]), center_[a] + half_[a]);
      }
    }
    return false;
  }

  /// True when the whole box is within the surface, extended beyond the cone's ends.
  [[nodiscard]] bool inside() const {
    using std::abs;
    const Real slack = slack_ * (Real(1.0) + abs(slope_));
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      Triple<Real> at;
      for (std::size_t a = 0; a < 3; ++a) {
        at[a] = ((corner >> a) & 1U) != 0 ? center_[a] + half_[a] : center_[a] - half_[a];
      }
      const Split<Real> split(at, axis_);
      if (!(split.distance + slack < radius_ + slope_ * split.along)) {
        return false;
      }
    }
    return true;
  }

 private:
  /// Whether the box lies beyond the solid along a direction, which may have any length.
  [[nodiscard]] bool separates(const Triple<Real>& direction) const {
    using std::abs;
    using std::max;
    const Split<Real> split(direction, axis_);
    const Real end = half_height_ * split.along;
    const Real narrowing = slope_ * half_height_;
    const Real solid =
        max(end + (radius_ + narrowing) * split.distance, (radius_ - narrowing) * split.distance - end);
    Real box = dot(center_, direction);
    Real size(0.0);
    for (std::size_t a = 0; a < 3; ++a) {
      box = box - half_[a] * abs(direction[a]);
      size = size + abs(direction[a]);
    }
    return box > solid + slack_ * size;
  }

  Triple<Real> axis_;
  Real half_height_;
  Real radius_;
  Real slope_;
  Triple<Real> center_;
  Triple<Real> half_;
  Real slack_;
};

}  // namespace detail

/// True when the surface meets the closed box [c - h, c + h]; may also be true when it does not, see above.
/// Real is the scalar of the arithmetic (double, or Counted to count operations).
template <class Real>
[[nodiscard]] inline bool overlaps(const QuadricShape& shape, const std::array<Real, 3>& c,
                                   const std::array<Real, 3>& h) {
  using std::abs;
  using std::max;
  std::array<Real, 3> center;
  Real size(shape.reach);
  Real nearest(0.0);
  Real farthest(0.0);
  for (std::size_t a = 0; a < 3; ++a) {
    if (Real(shape.lo[a]) > c[a] + h[a] || Real(shape.hi[a]) < c[a] - h[a]) {
      return false;
    }
    center[a] = c[a] - Real(shape.center[a]);
    const Real away = abs(center[a]);
    const Real gap = max(away - h[a], Real(0.0));
    nearest = nearest + gap * gap;
    farthest = farthest + (away + h[a]) * (away + h[a]);
    size = size + away + h[a];
  }
  const Real slack = Real(0x1p-45) * size;
  if (shape.kind == PrimitiveKind::sphere) {
    const Real least = max(Real(shape.radius) - slack, Real(0.0));
    const Real most = Real(shape.radius) + slack;
    return nearest <= most * most && farthest >= least * least;
  }
  const detail::ConeAgainstBox<Real> test(shape, center, h, slack);
  return !test.inside() && !test.apart();
}

}  // namespace marti::accel
