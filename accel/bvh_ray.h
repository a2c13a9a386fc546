// A ray as the walks of a bounding volume hierarchy see it, and what they share. bvh_walk.h says why no hit
// is missed.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "accel/bvh_nodes.h"
#include "accel/counted.h"
#include "accel/frame.h"
#include "accel/mailbox.h"
#include "accel/octree_start.h"
#include "accel/quadric_kernel.h"
#include "accel/ray.h"
#include "accel/triangles.h"
#include "accel/watertight.h"

namespace marti::accel {

/// The scalar in which boxes are tested: floats, which count where the kernel's scalar counts.
template <class Real>
using BoxFloat = std::conditional_t<std::is_same_v<Real, Counted>, CountedFloat, float>;

template <class Real>
[[nodiscard]] inline BoxFloat<Real> box_float(const Real& x) {
  return BoxFloat<Real>(static_cast<float>(plain(x)));
}

/// By how much boxes are enlarged.
inline constexpr double bvh_margin = 0x1p-18;
/// The reciprocal of a direction component at most.
inline constexpr double bvh_largest_reciprocal = 0x1p60;

/// The data of a walk, by reference.
template <class Node>
struct BvhView {
  using Record = Node;

  const Node* nodes;           ///< nodes[0] is the root's record
  const std::uint32_t* first;  ///< by record: the first child's number, where records do not hold it
  const BvhPrimitive* primitives;
  const TriangleSet* triangles;
  const RootFrame* frame;
  BvhSpace space;
  std::uint32_t root;         ///< the root's number
  bool vectors;               ///< sim::has_avx2()
  double far_rounding = 1.0;  ///< how often the usual error of rays from far away

  [[nodiscard]] std::uint32_t first_child(std::uint32_t record) const {
    if constexpr (requires { Node::first; }) {
      return nodes[record].first;
    } else {
      return first[record];
    }
  }
};

/// A child that waits for its visit.
template <class Float>
struct BvhWaiting {
  Float in;  ///< where the ray enters its box
  std::uint32_t number;
  BvhChild child;
};

/// Tests a primitive of a leaf. True when it became the best hit.
template <class Real, class Node>
inline bool test_bvh_primitive(const BvhView<Node>& view, const BvhPrimitive& primitive,
                               const RaySetup<Real>& setup, Best<Real>& best) {
  return primitive.id < view.triangles->triangles()
             ? intersect(setup, primitive.corners, primitive.id, best)
             : intersect_quadric(setup, view.triangles->quadric(primitive.id), primitive.id, best);
}

/// Tests the primitives of the leaf `number` in list order and tells the visitor. True when an occlusion
/// query (`Any`) found its hit.
template <bool Any, class Real, class Node, class Visitor>
inline bool test_bvh_leaf(const BvhView<Node>& view, std::uint32_t number, const BvhChild& leaf,
                          const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  const BvhPrimitive* const list = view.primitives + leaf.record;
  for (std::uint32_t k = 0; k < leaf.entries; ++k) {
    const std::uint32_t id = list[k].id;
    if (already_tested<Real>(visitor, k, id)) {
      continue;
    }
    const bool hit = test_bvh_primitive(view, list[k], setup, best);
    if constexpr (Any) {
      if (hit) {
        visitor.leaf(number, k + 1, leaf.entries);
        return true;
      }
    }
  }
  visitor.leaf(number, leaf.entries, leaf.entries);
  return false;
}

/// All children of a branch on each level can wait, but the one visited.
template <std::size_t Width>
inline constexpr std::size_t bvh_stack_size = (Width - 1) * 62 + 1;

/// The ray in the boxes' coordinates, from where it enters the root box. A plane p of an axis is met at
/// p * reciprocal + near, or + far, which includes the enlargement.
template <class Float>
struct BvhRay {
  std::array<Float, 3> reciprocal;
  std::array<Float, 3> near;
  std::array<Float, 3> far;
  std::array<std::uint32_t, 3> near_side;  ///< 1 where the ray meets the upper plane first
};

/// Converts the ray's parameters into distances along the BvhRay.
template <class Real>
class BvhDistance {
 public:
  BvhDistance(const BvhSpace& space, const Ray& ray, const WalkStart<Real>& start,
              const RaySetup<Real>& setup) {
    using std::abs;
    if (!start.far) {
      in_ = start.root.in;
      speed_ = abs(Real(ray.direction[static_cast<glm::length_t>(setup.kz)])) * Real(space.unit);
    }
  }
  [[nodiscard]] bool usable() const { return plain(speed_) >= 0x1p-900 && plain(speed_) <= 0x1p900; }

  /// The distance beyond which a box holds no hit nearer than that at t.
  [[nodiscard]] BoxFloat<Real> limit(const Real& t) const {
    using std::min;
    const Real distance = min((t - in_) * speed_, Real(0x1p100));
    return box_float<Real>(distance * Real(1.0 + 0x1p-20) + Real(0x1p-20));
  }

 private:
  Real in_{0.0};
  Real speed_{0.0};
};

template <class Real>
[[nodiscard]] inline BvhRay<BoxFloat<Real>> moved_ray(const BvhSpace& space, const Ray& ray,
                                                      const WalkStart<Real>& start,
                                                      const RaySetup<Real>& setup) {
  using std::abs;
  using std::min;
  BvhRay<BoxFloat<Real>> moved;
  const Real largest = abs(Real(ray.direction[static_cast<glm::length_t>(setup.kz)]));
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    const Real direction(ray.direction[axis]);
    const Real origin =
        ((Real(ray.origin[axis]) - Real(space.center[axis])) + start.root.in * direction) * Real(space.unit);
    moved.near_side[a] = plain((start.mask >> static_cast<std::uint32_t>(a)) & 1U);
    const Real size = min(start.inverse[a] * largest, Real(bvh_largest_reciprocal));
    const Real reciprocal = moved.near_side[a] != 0 ? -size : size;
    const Real at_origin = -origin * reciprocal;
    const Real enlargement = size * Real(bvh_margin);
    moved.reciprocal[a] = box_float<Real>(reciprocal);
    moved.near[a] = box_float<Real>(at_origin - enlargement);
    moved.far[a] = box_float<Real>(at_origin + enlargement);
  }
  return moved;
}

}  // namespace marti::accel
