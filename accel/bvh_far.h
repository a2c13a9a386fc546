// The slow, conservative walk of a bounding volume hierarchy, as the octree's (octree_far.h): for rays from
// far away, and for all rays whose hits are computed in floats. Boxes are tested in doubles, in the scene's
// coordinates, enlarged by the ray's own error.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "accel/bvh_ray.h"
#include "accel/far_ray.h"
#include "accel/ray.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// One branch. True when an occlusion query found its hit.
template <bool Any, class Real, class View, class Visitor>
bool walk_bvh_far_branch(const View& view, const FarRay& far, std::uint32_t number, std::uint32_t record,
                         const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  using Node = typename View::Record;
  visitor.branch(number);
  const Node& node = view.nodes[record];
  std::array<BvhWaiting<double>, Node::width> met;
  std::size_t count = 0;
  for (std::size_t c = 0; c < node.children(); ++c) {
    const scenes::Bounds box = node.box(c);
    const FarSpan span = far.span(view.space.center + view.space.inverse * box.lo,
                                  view.space.center + view.space.inverse * box.hi);
    if (span.in <= span.out && span.out >= far.t_min - far.slack) {
      std::size_t at = count++;
      for (; at > 0 && met[at - 1].in > span.in; --at) {
        met[at] = met[at - 1];
      }
      met[at] = {span.in, view.first_child(record) + static_cast<std::uint32_t>(c), node.child(c)};
    }
  }
  if constexpr (SeesEntered<Visitor>) {
    EnteredChildren entered;
    for (std::size_t k = 0; k < count; ++k) {
      entered.add(met[k].number - view.first_child(record));
    }
    visitor.entered(entered);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const BvhWaiting<double>& next = met[k];
    if (next.in > plain(best.t) + far.slack) {
      break;
    }
    if (next.child.entries != 0
            ? test_bvh_leaf<Any>(view, next.number, next.child, setup, best, visitor)
            : walk_bvh_far_branch<Any>(view, far, next.number, next.child.record, setup, best, visitor)) {
      return true;
    }
  }
  return false;
}

template <bool Any, class Real, class View, class Visitor>
bool walk_bvh_far(const View& view, const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best,
                  Visitor& visitor) {
  const scenes::Bounds& box = view.frame->box;
  if (box.empty()) {
    return false;
  }
  const FarRay far(*view.frame, ray, std::is_same_v<Real, float>, view.far_rounding);
  if (!far.may_hit(far.span(box.lo, box.hi), plain(best.t))) {
    return false;
  }
  return walk_bvh_far_branch<Any>(view, far, view.root, 0U, setup, best, visitor);
}

}  // namespace marti::accel
