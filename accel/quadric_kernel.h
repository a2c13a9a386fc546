// The ray/sphere and ray/cone intersections (cylinders are cones that do not narrow), two-sided.
//
// The ray is origin + s e with e = direction / its largest component, as in watertight.h; t = s / that
// component. Coordinates are relative to the primitive's centre, and the quadratic equation is set up at the
// point of the ray nearest to it, not at the origin: so a distant origin costs no digits of the discriminant
// (Haines, Gunther, Akenine-Moller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems,
// chapter 7, 2019). A cone's equation is moved once more, to the point nearest to its axis, and solved by
// q = -(B + sign(B) sqrt(B^2 - A C)) so that neither root cancels.
//
// Then every root is checked; the structures and the tracer rely on this. The point of the ray at s is
// computed again from s, and its distance from the surface from that. If the distance is more than the
// rounding of a good root,
//     2^-49 reach + 2 u L      (u = 2^-53, L the sum of the magnitudes of the centre's offset from the
//                               origin)
// the root is improved by Newton's method, twice at most and only as long as that helps. It is refused if it
// is still beyond
//     2^-46 reach + 4 u L.
// The point computed errs by less than 5 u of the distance travelled (a rounding each of the offset, e, the
// product, the sum, and t), and the distance from the surface by a few u of the reach. So of an accepted hit
// the point of the ray at t lies within
//     2^-46 reach + 4 u L + 5 u (L + reach) + 8 u reach
// of the surface: below 2^-42 D for origins within 128 D (half of what octree.h needs), and below
// 2^-45 D + 24 u L for any origin (far_ray.h has 2^-38 D and 32 u). The height along a cone's axis is
// checked at the foot of the perpendicular on the cone, so a steep one is hit no farther beyond its ends.
// No NaN passes the comparisons: what overflows is a miss.
//
// With floats u is 2^-24 and 2^-49 and 2^-46 are 2^-20 and 2^-17; coordinates are rounded to floats first.
//
// Which root is the hit depends only on the ray and the primitive, never on earlier hits.
#pragma once

#include <cstdint>

#include "accel/counted.h"
#include "accel/quadric_shape.h"
#include "accel/watertight.h"

namespace marti::accel {

/// Tests one sphere, cylinder or cone. True when it became the best hit; `best` then holds it, with weights
/// u, v, w of 0.
template <class Real>
bool intersect_quadric(const RaySetup<Real>& ray, const QuadricShape& shape, std::uint32_t id,
                       Best<Real>& best);

extern template bool intersect_quadric(const RaySetup<float>&, const QuadricShape&, std::uint32_t,
                                       Best<float>&);
extern template bool intersect_quadric(const RaySetup<double>&, const QuadricShape&, std::uint32_t,
                                       Best<double>&);
extern template bool intersect_quadric(const RaySetup<Counted>&, const QuadricShape&, std::uint32_t,
                                       Best<Counted>&);

}  // namespace marti::accel
