// The octree's walk after HERO (Agate, Grimsdale, Lister, "The HERO Algorithm for Ray-Tracing Octrees",
// Advances in Computer Graphics Hardware IV, 1989): only the ray's parameters at a node's six planes are
// carried; a mid-plane's parameter is the average of two; the children are met in the order of the
// mid-planes crossed, at most four of them, front to back; one XOR mask per ray turns the order of the
// planes into child numbers, whatever the signs of the direction. Nothing is mirrored, so nothing is
// rounded for it.
//
// This file holds the walk for any scalar; octree_walk_avx2.h has the same steps on vectors for doubles, and
// octree_far.h the slow walk for rays from far away. All three give the same hits, and the first two the same
// visits.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "accel/counted.h"
#include "accel/intersect.h"
#include "accel/mailbox.h"
#include "accel/octree_far.h"
#include "accel/octree_nodes.h"
#include "accel/octree_start.h"
#include "accel/octree_walk_avx2.h"
#include "accel/ray.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// Tests a leaf's primitives in list order. True when an occlusion query (`Any`) found its hit.
template <bool Any, class Real, class View, class Visitor>
inline bool test_leaf(const View& view, const typename View::Record& record, std::uint32_t node,
                      const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  const std::uint32_t entries = record.entries();
  const std::uint32_t* list = view.list(record);
  for (std::uint32_t k = 0; k < entries; ++k) {
    const std::uint32_t id = list[k];
    if (already_tested<Real>(visitor, k, id)) {
      continue;
    }
    const bool hit = intersect_primitive(setup, *view.triangles, id, best);
    if constexpr (Any) {
      if (hit) {
        visitor.leaf(node, k + 1, entries);
        return true;
      }
    }
  }
  visitor.leaf(node, entries, entries);
  return false;
}

/// Goes from a branch to its children on the ray: returns the first and puts the others on the stack, the
/// next one on top. `Span` is NodeSpan or has its members, plus a level where a walk needs it.
template <class Real, class Span>
inline Span enter_children(const Span& now, std::uint32_t first_child, const IntegerOf<Real>& mask,
                           std::array<Span, walk_stack_size>& stack, std::size_t& waiting) {
  using Integer = IntegerOf<Real>;
  const Real half(0.5);
  std::array<Real, 3> m;
  Integer side = 0U;
  for (std::uint32_t a = 0; a < 3; ++a) {
    m[a] = (now.s0[a] + now.s1[a]) * half;
    if (m[a] <= now.in) {
      side = side | (1U << a);
    }
  }
  const std::uint32_t outcome =
      (m[0] <= m[1] ? 1U : 0U) | (m[1] <= m[2] ? 2U : 0U) | (m[0] <= m[2] ? 4U : 0U);
  const unsigned order = plane_order[outcome];
  // Find the children in order of entry, then push the later ones.
  std::array<Span, 4> children;
  std::size_t found = 0;
  Real in = now.in;
  const auto enter = [&](Real until) {
    Span& child = children[found++];
    for (std::uint32_t a = 0; a < 3; ++a) {
      const bool upper = ((plain(side) >> a) & 1U) != 0;
      child.s0[a] = upper ? m[a] : now.s0[a];
      child.s1[a] = upper ? now.s1[a] : m[a];
    }
    child.in = in;
    child.out = until;
    child.node = plain(Integer(first_child) + (side ^ mask));
    if constexpr (requires { child.level; }) {
      child.level = now.level + 1;
    }
    in = until;
  };
  for (unsigned k = 0; k < 3; ++k) {
    const unsigned a = (order >> (2 * k)) & 3U;
    if (((plain(side) >> a) & 1U) != 0) {
      continue;
    }
    if (!(m[a] < now.out)) {
      break;
    }
    enter(m[a]);
    side = side | (1U << a);
  }
  enter(now.out);
  for (std::size_t k = found; k-- > 1;) {
    stack[waiting++] = children[k];
  }
  return children[0];
}

/// The walk itself. True when an occlusion query found its hit.
template <bool Any, class Real, class View, class Visitor>
bool walk_octree(const View& view, const WalkStart<Real>& start, const RaySetup<Real>& setup,
                 Best<Real>& best, Visitor& visitor) {
  std::array<NodeSpan<Real>, walk_stack_size> stack;
  std::size_t waiting = 0;
  NodeSpan<Real> now = start.root;
  for (;;) {
    const typename View::Record record = view.node(now.node);
    if (record.leaf()) {
      if (test_leaf<Any>(view, record, now.node, setup, best, visitor)) {
        return true;
      }
      if (!take_waiting(stack, waiting, best.t, start.slack, now)) {
        return false;
      }
      continue;
    }
    visitor.branch(now.node);
    now = enter_children<Real>(now, record.first, start.mask, stack, waiting);
  }
}

/// Chooses the walk for one ray. True when an occlusion query found its hit.
template <bool Any, class Real, class View, class Visitor>
inline bool query_octree(const View& view, const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best,
                         Visitor& visitor) {
  begin_query(visitor);
  const WalkStart<Real> start = start_walk(*view.frame, ray, setup);
  if (start.far) [[unlikely]] {
    return walk_octree_far<Any>(view, ray, setup, best, visitor);
  }
  if (!start.hits_root) {
    return false;
  }
#ifdef MARTI_AVX2
  // As four triangles are tested at a time, mailbox look-ups one by one would gain nothing.
  if constexpr (std::is_same_v<Real, double> && View::has_packs && !has_mailboxes<Visitor>) {
    if (view.packed != nullptr && !best.filter.on()) {
      return walk_octree_avx2<Any>(view, start, setup, best, visitor);
    }
  }
#endif
  return walk_octree<Any>(view, start, setup, best, visitor);
}

template <class Real, class View, class Visitor>
[[nodiscard]] Hit octree_closest(const View& view, const Ray& ray, Visitor& visitor) {
  const RaySetup<Real> setup(ray);
  Best<Real> best(setup, HitFilter(*view.triangles, visitor));
  query_octree<false>(view, ray, setup, best, visitor);
  return best.hit();
}

template <class Real, class View, class Visitor>
void octree_nearest(const View& view, const Ray& ray, NearestGaussians& buffer, Visitor& visitor) {
  const RaySetup<Real> setup(ray);
  Best<Real> best(setup, HitFilter(buffer, visitor));
  query_octree<false>(view, ray, setup, best, visitor);
}

template <class Real, class View, class Visitor>
[[nodiscard]] bool octree_occluded(const View& view, const Ray& ray, Visitor& visitor) {
  const RaySetup<Real> setup(ray);
  Best<Real> best(setup, HitFilter(*view.triangles, visitor));
  return query_octree<true>(view, ray, setup, best, visitor);
}

}  // namespace marti::accel
