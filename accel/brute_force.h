// No structure: every ray tests every primitive. All structures are compared with it.
#pragma once

#include <memory>
#include <string_view>

#include "accel/list_test.h"
#include "accel/mailbox.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// A single leaf, node 0, that lists every primitive.
class BruteForce {
 public:
  static constexpr std::string_view kind_name = "none";

  explicit BruteForce(std::shared_ptr<const TriangleSet> triangles);

  [[nodiscard]] const Topology& topology() const { return topology_; }
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  [[nodiscard]] const scenes::Bounds& bounds() const { return triangles_->bounds(); }

  /// The nearest hit. Real is the scalar of the arithmetic (double, Counted to count operations, or float for
  /// comparison).
  template <class Real = double, class Visitor>
  [[nodiscard]] Hit closest(const Ray& ray, Visitor& visitor) const {
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup, HitFilter(*triangles_, visitor));
    begin_query(visitor);
    test_list<false>(topology_, *triangles_, 0, setup, best, visitor);
    return best.hit();
  }

  /// Whether anything is hit; ends at the first hit.
  template <class Real = double, class Visitor>
  [[nodiscard]] bool occluded(const Ray& ray, Visitor& visitor) const {
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup, HitFilter(*triangles_, visitor));
    begin_query(visitor);
    return test_list<true>(topology_, *triangles_, 0, setup, best, visitor);
  }

 private:
  std::shared_ptr<const TriangleSet> triangles_;
  Topology topology_;
};

}  // namespace marti::accel
