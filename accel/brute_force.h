// No structure: every ray tests every primitive. All structures are compared with it.
#pragma once

#include <memory>
#include <string_view>

#include "accel/list_test.h"
#include "accel/mailbox.h"
#include "accel/queries.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// A single leaf, node 0, that lists every primitive.
class BruteForce : public Queries<BruteForce> {
 public:
  static constexpr std::string_view kind_name = "none";

  explicit BruteForce(std::shared_ptr<const TriangleSet> triangles);

  [[nodiscard]] const Topology& topology() const { return topology_; }
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  [[nodiscard]] const scenes::Bounds& bounds() const { return triangles_->bounds(); }

 private:
  friend class Queries<BruteForce>;
  template <bool Any, class Real, class Visitor>
  bool query(const Ray& /*ray*/, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
    begin_query(visitor);
    return test_list<Any>(topology_, *triangles_, 0, setup, best, visitor);
  }

  std::shared_ptr<const TriangleSet> triangles_;
  Topology topology_;
};

}  // namespace marti::accel
