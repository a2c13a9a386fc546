// The walk of a bounding volume hierarchy: of a branch, the children whose boxes the ray meets are visited in
// the order in which it enters them, those entered at once in the order of their numbers. This file holds the
// walk for any scalar; bvh_walk_avx2.h has the same steps on vectors, and bvh_far.h the slow walk for rays
// from far away. All three give the same hits, and the first two the same visits.
//
// Why no hit is missed, although boxes are tested in floats (u = 2^-24; coordinates are those of BvhSpace, in
// which the root box lies within -1 and 1):
//  1. The ray is moved to where it enters the root box, so its origin o lies within -1 and 1, too. Its
//     largest direction component is 1, and a reciprocal r of a component is at most 2^60: a smaller
//     component moves the ray by less than 2^-57 within the root box.
//  2. A plane p is met at p * r - o * r. The exact value is missed by at most 8 u (|p| + |o|) |r|, roundings
//     of r, of o * r, of the product and of the difference together; where planes are quantised by
//     20 u |r|. So each box is enlarged by 2^-18, which is a distance of 2^-18 |r| along the ray.
//  3. That is also far more than the distance between the point of an accepted hit and its primitive
//     (watertight.h, quadric_kernel.h) and than the roundings of making boxes.
//  4. A box is left out only if it is entered beyond the best hit, whose distance is raised by 2^-20 of it
//     and by 2^-20; and a hit is never refused for lying outside a box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "accel/bvh_far.h"
#include "accel/bvh_nodes.h"
#include "accel/bvh_walk_avx2.h"
#include "accel/counted.h"
#include "accel/octree_start.h"
#include "accel/ray.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// Counts integer operations that are not written with a counting scalar.
template <class Scalar>
inline void count_integers(std::uint32_t operations) {
  if constexpr (std::is_same_v<Scalar, CountedFloat>) {
    operation_counts().integer += operations;
  }
}

/// The planes of a BvhNode: where the ray meets plane number `side` of child c along an axis, but for the
/// enlargement.
template <class Float, std::size_t Width>
class BvhPlanes {
 public:
  BvhPlanes(const BvhNode<Width>& node, const BvhRay<Float>& ray) : node_(node), ray_(ray) {}

  [[nodiscard]] Float near(std::size_t axis, std::size_t c) const {
    return Float(node_.plane[ray_.near_side[axis]][axis][c]) * ray_.reciprocal[axis] + ray_.near[axis];
  }
  [[nodiscard]] Float far(std::size_t axis, std::size_t c) const {
    return Float(node_.plane[ray_.near_side[axis] ^ 1U][axis][c]) * ray_.reciprocal[axis] + ray_.far[axis];
  }

 private:
  const BvhNode<Width>& node_;
  const BvhRay<Float>& ray_;
};

/// The planes of a node in bytes: its steps and corner are multiplied by the reciprocals once.
template <BvhInBytes Node, class Float>
class BvhBytePlanes {
 public:
  BvhBytePlanes(const Node& node, const BvhRay<Float>& ray) : node_(node), ray_(ray) {
    for (std::size_t a = 0; a < 3; ++a) {
      step_[a] = Float(node.step(a)) * ray.reciprocal[a];
      const Float corner = Float(node.corner[a]) * ray.reciprocal[a];
      near_[a] = corner + ray.near[a];
      far_[a] = corner + ray.far[a];
    }
  }

  [[nodiscard]] Float near(std::size_t axis, std::size_t c) const {
    count_integers<Float>(1);  // from a byte to a float
    return Float(node_.plane[ray_.near_side[axis]][axis][c]) * step_[axis] + near_[axis];
  }
  [[nodiscard]] Float far(std::size_t axis, std::size_t c) const {
    count_integers<Float>(1);
    return Float(node_.plane[ray_.near_side[axis] ^ 1U][axis][c]) * step_[axis] + far_[axis];
  }

 private:
  const Node& node_;
  const BvhRay<Float>& ray_;
  std::array<Float, 3> step_;
  std::array<Float, 3> near_;
  std::array<Float, 3> far_;
};

template <class Float, std::size_t Width>
[[nodiscard]] BvhPlanes<Float, Width> planes_of(const BvhNode<Width>& node, const BvhRay<Float>& ray) {
  return {node, ray};
}
template <BvhInBytes Node, class Float>
[[nodiscard]] BvhBytePlanes<Node, Float> planes_of(const Node& node, const BvhRay<Float>& ray) {
  return {node, ray};
}

/// The walk itself. True when an occlusion query found its hit.
template <bool Any, class Real, class View, class Visitor>
bool walk_bvh(const View& view, const BvhRay<BoxFloat<Real>>& ray, const BvhDistance<Real>& distance,
              const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  using std::max;
  using std::min;
  using Node = typename View::Record;
  using Float = BoxFloat<Real>;
  using Waiting = BvhWaiting<Float>;
  std::array<Waiting, bvh_stack_size<Node::width>> stack;
  std::size_t waiting = 0;
  Float limit = distance.limit(best.t);
  Waiting now{Float(0.0F), view.root, {}};
  for (;;) {
    if (now.child.entries == 0) {
      visitor.branch(now.number);
      const Node& node = view.nodes[now.child.record];
      const auto planes = planes_of(node, ray);
      const std::uint32_t first = view.first_child(now.child.record);
      const std::size_t begin = waiting;
      // The children met are sorted on top of the stack, the next one last.
      for (std::size_t c = node.children(); c-- > 0;) {
        const Float in = max(max(planes.near(0, c), planes.near(1, c)), max(planes.near(2, c), Float(0.0F)));
        const Float out = min(min(planes.far(0, c), planes.far(1, c)), min(planes.far(2, c), limit));
        if (in <= out) {
          count_integers<Float>(Node::child_operations);
          std::size_t at = waiting++;
          for (; at > begin && stack[at - 1].in < in; --at) {
            stack[at] = stack[at - 1];
          }
          stack[at] = {in, first + static_cast<std::uint32_t>(c), node.child(c)};
        }
      }
      if constexpr (SeesEntered<Visitor>) {
        EnteredChildren entered;
        for (std::size_t at = waiting; at-- > begin;) {
          entered.add(stack[at].number - first);
        }
        visitor.entered(entered);
      }
    } else {
      const std::uint32_t before = best.primitive;
      if (test_bvh_leaf<Any>(view, now.number, now.child, setup, best, visitor)) {
        return true;
      }
      if (best.primitive != before) {
        limit = distance.limit(best.t);
      }
    }
    do {
      if (waiting == 0) {
        return false;
      }
      now = stack[--waiting];
    } while (now.in > limit);
  }
}

/// Chooses the walk for one ray. True when an occlusion query found its hit.
template <bool Any, class Real, class View, class Visitor>
inline bool query_bvh(const View& view, const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best,
                      Visitor& visitor) {
  if constexpr (std::is_same_v<Real, float>) {
    return walk_bvh_far<Any>(view, ray, setup, best, visitor);
  } else {
    const WalkStart<Real> start = start_walk(*view.frame, ray, setup);
    const BvhDistance<Real> distance(view.space, ray, start, setup);
    if (start.far || !distance.usable()) [[unlikely]] {
      return walk_bvh_far<Any>(view, ray, setup, best, visitor);
    }
    if (!start.hits_root) {
      return false;
    }
    const BvhRay<BoxFloat<Real>> moved = moved_ray(view.space, ray, start, setup);
#ifdef MARTI_AVX2
    if constexpr (std::is_same_v<Real, double>) {
      if (view.vectors) {
        return walk_bvh_avx2<Any>(view, moved, distance, setup, best, visitor);
      }
    }
#endif
    return walk_bvh<Any>(view, moved, distance, setup, best, visitor);
  }
}

}  // namespace marti::accel
