// The octree's slow, conservative walk, for rays that start so far away (or whose direction is so long or so
// short) that the rounding of their parameters is no longer small against the cells' margin. Every child's
// box is enlarged by the ray's own error; the boxes hit are visited in order of entry. All rays whose hits
// are computed in floats take this walk: the cells' margins are too thin for their error.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "accel/far_ray.h"
#include "accel/octree_nodes.h"
#include "accel/ray.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

template <bool Any, class Real, class View, class Visitor>
inline bool test_leaf(const View& view, const typename View::Record& record, std::uint32_t node,
                      const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor);

/// One branch of the slow walk. True when an occlusion query found its hit.
template <bool Any, class Real, class View, class Visitor>
bool walk_far_node(const View& view, const FarRay& far, std::uint32_t node, const glm::dvec3& lo,
                   const glm::dvec3& hi, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  const typename View::Record record = view.node(node);
  if (record.leaf()) {
    return test_leaf<Any>(view, record, node, setup, best, visitor);
  }
  visitor.branch(node);
  const glm::dvec3 mid = 0.5 * (lo + hi);
  std::array<std::pair<double, std::uint32_t>, 8> met;
  std::size_t count = 0;
  const auto box = [&](std::uint32_t child) {
    std::pair<glm::dvec3, glm::dvec3> b{lo, hi};
    for (int a = 0; a < 3; ++a) {
      (((child >> a) & 1U) != 0 ? b.first : b.second)[a] = mid[a];
    }
    return b;
  };
  for (std::uint32_t child = 0; child < 8; ++child) {
    const auto [child_lo, child_hi] = box(child);
    const FarSpan span = far.span(child_lo, child_hi);
    if (span.in <= span.out && span.out >= far.t_min - far.slack) {
      std::size_t at = count++;
      for (; at > 0 && met[at - 1].first > span.in; --at) {
        met[at] = met[at - 1];
      }
      met[at] = {span.in, child};
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (met[k].first > plain(best.t) + far.slack) {
      break;
    }
    const auto [child_lo, child_hi] = box(met[k].second);
    if (walk_far_node<Any>(view, far, record.first + met[k].second, child_lo, child_hi, setup, best,
                           visitor)) {
      return true;
    }
  }
  return false;
}

template <bool Any, class Real, class View, class Visitor>
bool walk_octree_far(const View& view, const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best,
                     Visitor& visitor) {
  const scenes::Bounds& box = view.frame->box;
  if (box.empty()) {
    return false;
  }
  const FarRay far(*view.frame, ray, std::is_same_v<Real, float>);
  if (!far.may_hit(far.span(box.lo, box.hi), plain(best.t))) {
    return false;
  }
  return walk_far_node<Any>(view, far, 0U, box.lo, box.hi, setup, best, visitor);
}

}  // namespace marti::accel
