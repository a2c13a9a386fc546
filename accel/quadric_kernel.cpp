#include "accel/quadric_kernel.h"

#include <array>
#include <cmath>
#include <utility>

namespace marti::accel {

namespace {

/// Coordinates along kx, ky and kz of the ray.
template <class Real>
struct Vector {
  Real x;
  Real y;
  Real z;
};

template <class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// a + b * s
template <class Real>
Vector<Real> along(const Vector<Real>& a, const Vector<Real>& b, Real s) {
  return {a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

/// The ray as it comes to one primitive.
template <class Real>
struct Approach {
  Vector<Real> center;     ///< the primitive's centre, from the origin
  Vector<Real> direction;  ///< its component z is 1
  Real squared;            ///< of the direction
  Real nearest;            ///< parameter of the point nearest to the centre
  Vector<Real> offset;     ///< that point, from the centre
  Real tolerance;          ///< how far from the surface a hit may be

  Approach(const RaySetup<Real>& ray, const QuadricShape& shape)
      : center{Real(shape.center[ray.kx]) - ray.origin_x, Real(shape.center[ray.ky]) - ray.origin_y,
               Real(shape.center[ray.kz]) - ray.origin_z},
        direction{ray.shear_x, ray.shear_y, Real(1.0)} {
    using std::abs;
    squared = ray.shear_x * ray.shear_x + ray.shear_y * ray.shear_y + Real(1.0);
    nearest = (center.x * ray.shear_x + center.y * ray.shear_y + center.z) / squared;
    offset = at(nearest);
    tolerance = Real(0x1p-44 * shape.reach) + Real(0x1p-51) * (abs(center.x) + abs(center.y) + abs(center.z));
  }

  /// The point at s, from the primitive's centre.
  [[nodiscard]] Vector<Real> at(Real s) const {
    return {direction.x * s - center.x, direction.y * s - center.y, s - center.z};
  }
};

/// Takes the hit at t when it is the best.
template <class Real>
bool offer(Real t, std::uint32_t id, Best<Real>& best) {
  if (!(t <= best.t) || (t == best.t && id >= best.primitive)) {
    return false;
  }
  best.t = t;
  best.primitive = id;
  best.edges = {Real(0.0), Real(0.0), Real(0.0)};
  best.det = Real(1.0);
  return true;
}

/// The first of two roots, in order of t, that `settle` confirms and that is not before t_min. `settle` may
/// improve the root it is given.
template <class Real, class Settle>
bool choose(const RaySetup<Real>& ray, Real low, Real high, std::uint32_t id, Best<Real>& best,
            const Settle& settle) {
  if (ray.scale < Real(0.0)) {
    std::swap(low, high);
  }
  for (Real s : {low, high}) {
    if (s * ray.scale >= ray.t_min && settle(s)) {
      const Real t = s * ray.scale;
      if (t >= ray.t_min) {
        return offer(t, id, best);
      }
    }
  }
  return false;
}

template <class Real>
bool intersect_sphere(const RaySetup<Real>& ray, const QuadricShape& shape, std::uint32_t id,
                      Best<Real>& best) {
  using std::abs;
  using std::sqrt;
  const Approach<Real> approach(ray, shape);
  const Real radius_squared(shape.radius * shape.radius);
  const Real inside = radius_squared - dot(approach.offset, approach.offset);
  if (!(inside >= Real(0.0))) {
    return false;
  }
  const Real half = sqrt(inside / approach.squared);
  // | |p|^2 - r^2 | <= tolerance r implies | |p| - r | <= tolerance.
  const Real limit = approach.tolerance * Real(shape.radius);
  return choose(ray, approach.nearest - half, approach.nearest + half, id, best, [&](Real& s) {
    for (int step = 0; step < 3; ++step) {
      const Vector<Real> point = approach.at(s);
      const Real excess = dot(point, point) - radius_squared;
      if (abs(excess) <= limit) {
        return true;
      }
      s = s - excess / (Real(2.0) * dot(point, approach.direction));
    }
    return false;
  });
}

template <class Real>
bool intersect_cone(const RaySetup<Real>& ray, const QuadricShape& shape, std::uint32_t id,
                    Best<Real>& best) {
  using std::abs;
  using std::sqrt;
  const Approach<Real> approach(ray, shape);
  if (!(dot(approach.offset, approach.offset) <= Real(shape.reach * shape.reach))) {
    return false;
  }
  const Vector<Real> axis{Real(shape.axis[ray.kx]), Real(shape.axis[ray.ky]), Real(shape.axis[ray.kz])};
  const Real radius(shape.radius);
  const Real slope(shape.slope);
  // The components along the axis and across it.
  const Real climb = dot(approach.direction, axis);
  const Vector<Real> across = along(approach.direction, axis, -climb);
  const Real across_squared = dot(across, across);
  Real height = dot(approach.offset, axis);
  Vector<Real> radial = along(approach.offset, axis, -height);
  Real moved = -(dot(radial, across) / across_squared);
  if (!(abs(moved) <= Real(2.0 * shape.reach))) {
    moved = Real(0.0);  // the ray runs nearly along the axis: the nearest point is out of the way
  }
  radial = along(radial, across, moved);
  height = height + climb * moved;

  const Real growth = slope * climb;
  const Real at_height = radius + slope * height;
  const Real a = across_squared - growth * growth;
  const Real b = dot(radial, across) - growth * at_height;
  const Real c = dot(radial, radial) - at_height * at_height;
  const Real discriminant = b * b - a * c;
  if (!(discriminant >= Real(0.0))) {
    return false;
  }
  const Real root = sqrt(discriminant);
  const Real q = b < Real(0.0) ? root - b : -(b + root);
  Real low = q / a;
  Real high = c / q;
  if (high < low) {
    std::swap(low, high);
  }
  const Real start = approach.nearest + moved;
  const Real foot(shape.slope * shape.cosine * shape.cosine);
  return choose(ray, start + low, start + high, id, best, [&](Real& s) {
    for (int step = 0; step < 3; ++step) {
      const Vector<Real> point = approach.at(s);
      const Real h = dot(point, axis);
      const Vector<Real> out = along(point, axis, -h);
      const Real distance = sqrt(dot(out, out));
      const Real excess = distance - (radius + slope * h);
      if (abs(excess) * Real(shape.cosine) <= approach.tolerance) {
        return abs(h + excess * foot) <= Real(shape.half);
      }
      s = s - excess / (dot(out, across) / distance - growth);
    }
    return false;
  });
}

}  // namespace

template <class Real>
bool intersect_quadric(const RaySetup<Real>& ray, const QuadricShape& shape, std::uint32_t id,
                       Best<Real>& best) {
  return shape.kind == PrimitiveKind::sphere ? intersect_sphere(ray, shape, id, best)
                                             : intersect_cone(ray, shape, id, best);
}

template bool intersect_quadric(const RaySetup<double>&, const QuadricShape&, std::uint32_t, Best<double>&);
template bool intersect_quadric(const RaySetup<Counted>&, const QuadricShape&, std::uint32_t, Best<Counted>&);

}  // namespace marti::accel
