// Hit points on spheres, cylinders and cones, made ready for shading.
#pragma once

#include "accel/quadric_shape.h"
#include "processors/program/shading.h"

namespace marti::processors::program {

/// The surface at `hit`, the point of a ray at its t, seen along `direction`. The point is moved onto the
/// surface along the normal; what remains of its error is the rounding of that move, in each coordinate.
///
/// The kernel accepts no hit that is farther from the surface than 2^-46 of the shape's reach and some 20
/// roundings (quadric_kernel.h; in floats 2^-17). A ray that leaves outwards from a margin of 2^-45 (2^-16)
/// stays outside of that margin, and one that leaves inwards hits the surface only on the far side. The outer
/// side is the one away from the centre or axis.
template <typename Real>
Surface<Real> quadric_surface(const accel::QuadricShape& shape, const Vec3<Real>& hit,
                              const Vec3<Real>& direction) {
  using std::sqrt;
  const Vec3<Real> center(Real(shape.center[0]), Real(shape.center[1]), Real(shape.center[2]));
  const Vec3<Real> axis(Real(shape.axis[0]), Real(shape.axis[1]), Real(shape.axis[2]));
  const Vec3<Real> from_center = hit - center;
  const Real height = dot(from_center, axis);  // 0 for a sphere, whose axis is 0
  const Vec3<Real> on_axis = axis * height;
  Vec3<Real> out = from_center - on_axis;
  const Real squared = squared_in_range(out);

  Surface<Real> surface;
  Vec3<Real> radial;
  if (squared > Real(0.0)) {
    const Vec3<Real> unit = out * (Real(1.0) / sqrt(squared));
    radial = unit * (Real(shape.radius) + Real(shape.slope) * height);
    surface.geometric = (unit - axis * Real(shape.slope)) * Real(shape.cosine);
  } else {
    // The apex of a cone: its normal is taken along the axis.
    surface.geometric = shape.slope < 0.0 ? axis : -axis;
  }
  const Vec3<Real> offset = on_axis + radial;
  surface.point = center + offset;
  surface.error = absolute(surface.point) * Real(gamma_bound<Real>(1)) +
                  (absolute(on_axis) + absolute(radial)) * Real(gamma_bound<Real>(8));
  surface.margin = Real(256.0 * rounding<Real> * shape.reach);
  // The normal turns by the error of the point over the radius there, and by a few roundings.
  const auto around = dot(held(radial), held(radial));
  const Held<Real> off =
      Held<Real>(2) * largest(held(surface.error)) + static_cast<Held<Real>>(surface.margin);
  surface.tilt_squared = around > 0 ? off * off / around : Held<Real>(0);
  surface.outside = dot(surface.geometric, direction) < Real(0.0);
  if (!surface.outside) {
    surface.geometric = -surface.geometric;
  }
  surface.normal = surface.geometric;
  return surface;
}

}  // namespace marti::processors::program
