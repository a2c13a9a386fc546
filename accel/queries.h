// The questions that rays ask, for structures that answer all with one walk.
#pragma once

#include "accel/ray.h"
#include "accel/watertight.h"

namespace marti::accel {

/// The base of a structure that has a member `query<Any>(ray, setup, best, visitor)`, its walk. With Any it
/// returns whether something was hit, and may end at the first hit.
template <class Structure>
class Queries {
 public:
  /// The nearest hit. Real is the scalar of the arithmetic (double, Counted to count operations, or float for
  /// comparison).
  template <class Real = double, class Visitor>
  [[nodiscard]] Hit closest(const Ray& ray, Visitor& visitor) const {
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup, HitFilter(structure().triangles(), visitor));
    structure().template query<false>(ray, setup, best, visitor);
    return best.hit();
  }

  /// Whether anything is hit; ends at the first hit.
  template <class Real = double, class Visitor>
  [[nodiscard]] bool occluded(const Ray& ray, Visitor& visitor) const {
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup, HitFilter(structure().triangles(), visitor));
    return structure().template query<true>(ray, setup, best, visitor);
  }

  /// Fills a buffer with the nearest Gaussians, whose proxies the triangles must be.
  template <class Real = double, class Visitor>
  void nearest(const Ray& ray, NearestGaussians& buffer, Visitor& visitor) const {
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup, HitFilter(buffer, visitor));
    structure().template query<false>(ray, setup, best, visitor);
  }

 private:
  friend Structure;
  Queries() = default;
  [[nodiscard]] const Structure& structure() const { return static_cast<const Structure&>(*this); }
};

}  // namespace marti::accel
