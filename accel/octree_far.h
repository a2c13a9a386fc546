// The octree's slow, conservative walk, for rays that start so far away (or run so fast or so slowly) that
// the rounding of their parameters is no longer small against the cells' margin. Every child's box is
// enlarged by the ray's own error and tested against the ray; those met are visited in order of entry.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "accel/octree_nodes.h"
#include "accel/ray.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

template <bool Any, class Real, class Visitor>
inline bool test_leaf(const OctreeView& view, const OctreeNode& record, std::uint32_t node,
                      const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor);

/// A ray's parameters inside an enlarged box; empty when in > out. Never NaN.
struct FarSpan {
  double in;
  double out;
};

/// What the slow walk knows of its ray.
struct FarRay {
  std::array<double, 3> origin;
  std::array<double, 3> direction;
  double t_min;
  double margin;  ///< by how much boxes are enlarged: kernel, slab and cell errors together
  double slack;   ///< the same as a parameter

  FarRay(const OctreeFrame& frame, const Ray& ray)
      : origin{ray.origin.x, ray.origin.y, ray.origin.z},
        direction{ray.direction.x, ray.direction.y, ray.direction.z},
        t_min(ray.t_min) {
    const std::array<double, 3> center{frame.center.x, frame.center.y, frame.center.z};
    double reach = frame.far;
    double speed = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      reach = std::max(reach, std::abs(origin[a] - center[a]));
      speed = std::max(speed, std::abs(direction[a]));
    }
    margin = 4.0 * frame.delta + 32.0 * 0x1p-53 * reach;
    slack = 4.0 * margin / speed;
  }

  [[nodiscard]] FarSpan span(const glm::dvec3& box_lo, const glm::dvec3& box_hi) const {
    FarSpan span{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (int a = 0; a < 3; ++a) {
      const auto k = static_cast<std::size_t>(a);
      const double lo = box_lo[a] - margin - origin[k];
      const double hi = box_hi[a] + margin - origin[k];
      if (direction[k] == 0.0) {
        if (lo > 0.0 || hi < 0.0) {
          return {1.0, 0.0};
        }
        continue;
      }
      double near = lo / direction[k];
      double far = hi / direction[k];
      if (near > far) {
        std::swap(near, far);
      }
      span.in = std::max(span.in, near);
      span.out = std::min(span.out, far);
    }
    return span;
  }
};

/// One branch of the slow walk. True when an occlusion query found its hit.
template <bool Any, class Real, class Visitor>
bool walk_far_node(const OctreeView& view, const FarRay& far, std::uint32_t node, const glm::dvec3& lo,
                   const glm::dvec3& hi, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  const OctreeNode record = view.nodes[node];
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

template <bool Any, class Real, class Visitor>
bool walk_octree_far(const OctreeView& view, const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best,
                     Visitor& visitor) {
  const scenes::Bounds& box = view.frame->box;
  if (box.empty()) {
    return false;
  }
  const FarRay far(*view.frame, ray);
  const FarSpan span = far.span(box.lo, box.hi);
  if (!(span.in <= span.out) || span.out < far.t_min - far.slack || span.in > plain(best.t) + far.slack) {
    return false;
  }
  return walk_far_node<Any>(view, far, 0U, box.lo, box.hi, setup, best, visitor);
}

}  // namespace marti::accel
