#include "accel/bvh_box.h"

#include "accel/counted.h"

namespace marti::accel {

namespace {

// The sum with 0 turns -0 into 0, so that equal numbers are the same bits.
template <class Real>
float rounded_down(Real x) {
  const auto near = static_cast<float>(plain(x));
  return (Real(near) > x ? std::nextafter(near, -BvhBox::inf) : near) + 0.0F;
}

template <class Real>
float rounded_up(Real x) {
  const auto near = static_cast<float>(plain(x));
  return (Real(near) < x ? std::nextafter(near, BvhBox::inf) : near) + 0.0F;
}

}  // namespace

template <class Real>
BvhBox bvh_box_of(const BvhSpace& space, const TriangleSet& triangles, std::uint32_t id) {
  using std::max;
  using std::min;
  BvhBox box;
  box.lo[3] = 0.0F;
  box.hi[3] = 0.0F;
  for (std::size_t a = 0; a < 3; ++a) {
    Real lo = 0.0;
    Real hi = 0.0;
    if (id < triangles.triangles()) {
      const TriangleCorners& corners = triangles[id];
      const Real third = corners[6 + a];
      lo = min(min(Real(corners[a]), Real(corners[3 + a])), third);
      hi = max(max(Real(corners[a]), Real(corners[3 + a])), third);
    } else {
      lo = triangles.quadric(id).lo[a];
      hi = triangles.quadric(id).hi[a];
    }
    const Real center = space.center[static_cast<int>(a)];
    box.lo[a] = rounded_down<Real>((lo - center) * Real(space.unit));
    box.hi[a] = rounded_up<Real>((hi - center) * Real(space.unit));
  }
  return box;
}

template BvhBox bvh_box_of<double>(const BvhSpace& space, const TriangleSet& triangles, std::uint32_t id);
template BvhBox bvh_box_of<Counted>(const BvhSpace& space, const TriangleSet& triangles, std::uint32_t id);

}  // namespace marti::accel
