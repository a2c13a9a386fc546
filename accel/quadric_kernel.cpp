#include "accel/quadric_kernel.h"

#include <cmath>
#include <utility>

namespace marti::accel {

namespace {

/// Coordinates along the ray's axes kx, ky and kz.
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

/// The ray relative to one primitive.
template <class Real>
struct Approach {
  Vector<Real> center;     ///< the primitive's centre, relative to the ray's origin
  Vector<Real> direction;  ///< its component z is 1
  Real squared;            ///< squared length of the direction
  Real nearest;            ///< parameter of the point nearest to the centre
  Vector<Real> offset;     ///< that point, relative to the centre
  Real rounding;           ///< largest distance from the surface of a root that needs no improvement
  Real tolerance;          ///< largest distance from the surface of an accepted root

  Approach(const RaySetup<Real>& ray, const QuadricShape& shape)
      : center{Real(shape.center[ray.kx]) - ray.origin_x, Real(shape.center[ray.ky]) - ray.origin_y,
               Real(shape.center[ray.kz]) - ray.origin_z},
        direction{ray.shear_x, ray.shear_y, Real(1.0)} {
    using std::abs;
    squared = ray.shear_x * ray.shear_x + ray.shear_y * ray.shear_y + Real(1.0);
    nearest = (center.x * ray.shear_x + center.y * ray.shear_y + center.z) / squared;
    offset = at(nearest);
    constexpr double spacing = RealFormat<Real>::spacing;
    const Real away = Real(spacing) * (abs(center.x) + abs(center.y) + abs(center.z));
    rounding = Real(8.0 * spacing * shape.reach) + away;
    tolerance = Real(64.0 * spacing * shape.reach) + (away + away);
  }

  /// The point at s, from the primitive's centre.
  [[nodiscard]] Vector<Real> at(Real s) const {
    return {direction.x * s - center.x, direction.y * s - center.y, s - center.z};
  }
};

/// Improves the root s until its point is within `rounding` of the surface, as long as that helps; returns
/// whether it is then within `tolerance` and the cone's ends. surface.place(s) gives a point's signed
/// distance `excess` beyond the surface, surface.within(place) whether it is within the ends,
/// surface.rate(place) how fast the excess grows with s.
template <class Real, class Surface>
bool settle(Real& s, const Surface& surface) {
  using std::abs;
  auto place = surface.place(s);
  for (int step = 0; step < 2 && !(abs(place.excess) <= surface.rounding); ++step) {
    const Real better = s - place.excess / surface.rate(place);
    const auto next = surface.place(better);
    if (!(abs(next.excess) < abs(place.excess))) {
      break;
    }
    s = better;
    place = next;
  }
  return abs(place.excess) <= surface.tolerance && surface.within(place);
}

/// Makes the hit at t the best one if it is better.
template <class Real>
bool offer(Real t, std::uint32_t id, Best<Real>& best) {
  if (!(t <= best.t) || (t == best.t && best.first + id >= best.primitive)) {
    return false;
  }
  best.t = t;
  best.primitive = best.first + id;
  best.edges = {Real(0.0), Real(0.0), Real(0.0)};
  best.det = Real(1.0);
  return true;
}

/// Offers the first of two roots, in order of t, that `settle` confirms and that is not before t_min.
template <class Real, class Surface>
bool choose(const RaySetup<Real>& ray, Real low, Real high, const Surface& surface, std::uint32_t id,
            Best<Real>& best) {
  if (ray.scale < Real(0.0)) {
    std::swap(low, high);
  }
  for (Real s : {low, high}) {
    if (s * ray.scale >= ray.t_min && settle(s, surface)) {
      const Real t = s * ray.scale;
      if (t >= ray.t_min) {
        return offer(t, id, best);
      }
    }
  }
  return false;
}

template <class Real>
struct SphereSurface {
  struct Place {
    Vector<Real> point;
    Real excess;
  };
  const Approach<Real>& approach;
  Real radius_squared;
  // The excess is of squared distances: | |p|^2 - r^2 | <= tolerance r implies | |p| - r | <= tolerance.
  Real rounding;
  Real tolerance;

  [[nodiscard]] Place place(Real s) const {
    const Vector<Real> point = approach.at(s);
    return {point, dot(point, point) - radius_squared};
  }
  [[nodiscard]] Real rate(const Place& at) const { return Real(2.0) * dot(at.point, approach.direction); }
  [[nodiscard]] bool within(const Place& /*at*/) const { return true; }
};

template <class Real>
struct ConeSurface {
  struct Place {
    Vector<Real> out;  ///< vector from the axis to the point
    Real distance;
    Real height;
    Real excess;
  };
  const Approach<Real>& approach;
  const QuadricShape& shape;
  const Vector<Real>& axis;
  const Vector<Real>& across;  ///< the direction's component across the axis
  Real growth;                 ///< growth of the radius with s
  Real rounding;
  Real tolerance;

  [[nodiscard]] Place place(Real s) const {
    using std::sqrt;
    const Vector<Real> point = approach.at(s);
    const Real height = dot(point, axis);
    const Vector<Real> out = along(point, axis, -height);
    const Real distance = sqrt(dot(out, out));
    const Real radius = Real(shape.radius) + Real(shape.slope) * height;
    return {out, distance, height, (distance - radius) * Real(shape.cosine)};
  }
  [[nodiscard]] Real rate(const Place& at) const {
    return (dot(at.out, across) / at.distance - growth) * Real(shape.cosine);
  }
  /// Whether the nearest point of the cone lies between its ends.
  [[nodiscard]] bool within(const Place& at) const {
    using std::abs;
    return abs(at.height + at.excess * Real(shape.slope * shape.cosine)) <= Real(shape.half);
  }
};

template <class Real>
bool intersect_sphere(const RaySetup<Real>& ray, const QuadricShape& shape, std::uint32_t id,
                      Best<Real>& best) {
  using std::sqrt;
  const Approach<Real> approach(ray, shape);
  const Real radius_squared = Real(shape.radius * shape.radius);
  const Real inside = radius_squared - dot(approach.offset, approach.offset);
  if (!(inside >= Real(0.0))) {
    return false;
  }
  const Real half = sqrt(inside / approach.squared);
  const Real radius = Real(shape.radius);
  const SphereSurface<Real> surface{approach, radius_squared, approach.rounding * radius,
                                    approach.tolerance * radius};
  return choose(ray, approach.nearest - half, approach.nearest + half, surface, id, best);
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
  const Real radius = Real(shape.radius);
  const Real slope = Real(shape.slope);
  // The components along the axis and across it.
  const Real climb = dot(approach.direction, axis);
  const Vector<Real> across = along(approach.direction, axis, -climb);
  const Real across_squared = dot(across, across);
  Real height = dot(approach.offset, axis);
  Vector<Real> radial = along(approach.offset, axis, -height);
  Real moved = -(dot(radial, across) / across_squared);
  if (!(abs(moved) <= Real(2.0 * shape.reach))) {
    moved = Real(0.0);  // the ray runs nearly along the axis: the nearest point is too far away to help
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
  const ConeSurface<Real> surface{approach,          shape, axis, across, growth, approach.rounding,
                                  approach.tolerance};
  return choose(ray, start + low, start + high, surface, id, best);
}

}  // namespace

template <class Real>
bool intersect_quadric(const RaySetup<Real>& ray, const QuadricShape& shape, std::uint32_t id,
                       Best<Real>& best) {
  return shape.kind == PrimitiveKind::sphere ? intersect_sphere(ray, shape, id, best)
                                             : intersect_cone(ray, shape, id, best);
}

template bool intersect_quadric(const RaySetup<float>&, const QuadricShape&, std::uint32_t, Best<float>&);
template bool intersect_quadric(const RaySetup<double>&, const QuadricShape&, std::uint32_t, Best<double>&);
template bool intersect_quadric(const RaySetup<Counted>&, const QuadricShape&, std::uint32_t, Best<Counted>&);

}  // namespace marti::accel
