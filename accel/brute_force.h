// No structure at all: every ray tests every primitive. The oracle all structures are compared with.
#pragma once

#include <memory>
#include <string_view>

#include "accel/intersect.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// One leaf, node 0, that lists every primitive.
class BruteForce {
 public:
  static constexpr std::string_view kind_name = "none";

  explicit BruteForce(std::shared_ptr<const TriangleSet> triangles);

  [[nodiscard]] const Topology& topology() const { return topology_; }
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  [[nodiscard]] const scenes::Bounds& bounds() const { return triangles_->bounds(); }

  /// The nearest hit. Real is the scalar the arithmetic is done in (double, or Counted to count it).
  template <class Real = double, class Visitor>
  [[nodiscard]] Hit closest(const Ray& ray, Visitor& visitor) const {
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup);
    const std::uint32_t n = triangles_->size();
    for (std::uint32_t id = 0; id < n; ++id) {
      intersect_primitive(setup, *triangles_, id, best);
    }
    visitor.leaf(0, n, n);
    return best.hit();
  }

  /// Whether anything is hit; ends at the first hit.
  template <class Real = double, class Visitor>
  [[nodiscard]] bool occluded(const Ray& ray, Visitor& visitor) const {
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup);
    const std::uint32_t n = triangles_->size();
    for (std::uint32_t id = 0; id < n; ++id) {
      if (intersect_primitive(setup, *triangles_, id, best)) {
        visitor.leaf(0, id + 1, n);
        return true;
      }
    }
    visitor.leaf(0, n, n);
    return false;
  }

 private:
  std::shared_ptr<const TriangleSet> triangles_;
  Topology topology_;
};

}  // namespace marti::accel
