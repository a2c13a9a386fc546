#include "accel/bvh_box.h"

namespace marti::accel {

namespace {

// The sum with 0 turns -0 into 0, so that equal numbers are the same bits.
float rounded_down(double x) {
  const auto near = static_cast<float>(x);
  return (static_cast<double>(near) > x ? std::nextafter(near, -BvhBox::inf) : near) + 0.0F;
}

float rounded_up(double x) {
  const auto near = static_cast<float>(x);
  return (static_cast<double>(near) < x ? std::nextafter(near, BvhBox::inf) : near) + 0.0F;
}

}  // namespace

BvhBox bvh_box_of(const BvhSpace& space, const TriangleSet& triangles, std::uint32_t id) {
  BvhBox box;
  box.lo[3] = 0.0F;
  box.hi[3] = 0.0F;
  for (std::size_t a = 0; a < 3; ++a) {
    double lo = 0.0;
    double hi = 0.0;
    if (id < triangles.triangles()) {
      const TriangleCorners& corners = triangles[id];
      lo = std::min({corners[a], corners[3 + a], corners[6 + a]});
      hi = std::max({corners[a], corners[3 + a], corners[6 + a]});
    } else {
      lo = triangles.quadric(id).lo[a];
      hi = triangles.quadric(id).hi[a];
    }
    const double center = space.center[static_cast<int>(a)];
    box.lo[a] = rounded_down((lo - center) * space.unit);
    box.hi[a] = rounded_up((hi - center) * space.unit);
  }
  return box;
}

}  // namespace marti::accel
