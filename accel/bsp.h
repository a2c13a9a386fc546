// The BSP tree: nodes split in two at their centre, across x, y and z in turn (Kaplan, "Space-tracing: a
// constant time ray-tracer", SIGGRAPH '85 course notes), walked from the root down, front to back, or from
// leaf to leaf by a point pushed through their faces (bsp_push.h).
//
// Three levels of it make one level of the octree, and its cells are the octree's: the root box, the margin
// delta, the planes and the rule by which cells list triangles are the same. The argument of octree.h
// therefore holds for the walk from the root down without change: the walk carries the ray's parameters at a
// node's six planes, averages two for the centre plane, and cuts the node's piece of the ray there without a
// gap.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <type_traits>
#include <vector>

#include "accel/bsp_push.h"
#include "accel/far_ray.h"
#include "accel/frame.h"
#include "accel/list_test.h"
#include "accel/mailbox.h"
#include "accel/octree.h"
#include "accel/octree_start.h"
#include "accel/queries.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/traversal.h"
#include "accel/triangles.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// The two walks. They give the same hits.
enum class BspWalk : std::uint8_t { recursive, push_point };
inline constexpr std::array<std::string_view, 2> bsp_walk_names = {"recursive", "push_point"};

[[nodiscard]] constexpr Traversal traversal_of(BspWalk walk) {
  return walk == BspWalk::push_point ? Traversal::bsp_push_point : Traversal::bsp_recursive;
}

struct BspOptions {
  /// A node that lists more than this many triangles is split, unless it is at the deepest level. At least 1.
  std::uint32_t max_objects = 8;
  /// In levels of the octree, so that both have the same smallest cells: the tree's deepest level is 3
  /// (max_level - 1) + 1, the root being level 1. From 1 to 21.
  std::uint32_t max_level = 12;
  /// As OctreeOptions::max_entries.
  std::uint64_t max_entries = std::uint64_t{1} << 25;
  BspWalk walk = BspWalk::recursive;
  /// As OctreeOptions::memory.
  sim::MemoryBudget memory{};
};

class Bsp : public Queries<Bsp> {
 public:
  static constexpr std::string_view kind_name = "bsp";

  /// Builds the whole tree, level by level. Throws UserError when an option is out of range. The first child
  /// of a branch is the lower half. A node with more than max_objects triangles remains a leaf for the
  /// octree's reasons: it is on the deepest level; its children would be thinner than 8 delta; max_entries or
  /// 2^28 nodes are reached; or, before a split across x, the next three splits would separate nothing: every
  /// triangle meets the same octants of the node, two or more.
  [[nodiscard]] static Bsp build(std::shared_ptr<const TriangleSet> triangles,
                                 const BspOptions& options = {});

  [[nodiscard]] const Topology& topology() const { return topology_; }
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  [[nodiscard]] const BspOptions& options() const { return options_; }
  [[nodiscard]] const scenes::Bounds& bounds() const { return frame_.box; }
  [[nodiscard]] double delta() const { return frame_.delta; }
  [[nodiscard]] Traversal traversal() const { return traversal_of(options_.walk); }
  /// levels()[i] is level i + 1 of this tree.
  [[nodiscard]] const std::vector<LevelStatistics>& levels() const { return levels_; }

 private:
  friend class Queries<Bsp>;
  /// At most one sibling a level waits.
  static constexpr std::size_t stack_size = 3 * 20 + 1;

  Bsp() = default;

  template <bool Any, class Real, class Visitor>
  bool query(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const;
  template <bool Any, class Real, class Visitor>
  bool walk(const WalkStart<Real>& start, const RaySetup<Real>& setup, Best<Real>& best,
            Visitor& visitor) const;
  template <bool Any, class Real, class Visitor>
  bool walk_far(const FarRay& far, std::uint32_t node, const glm::dvec3& lo, const glm::dvec3& hi,
                const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const;

  std::shared_ptr<const TriangleSet> triangles_;
  BspOptions options_;
  RootFrame frame_;
  Topology topology_;
  std::vector<LevelStatistics> levels_;
  std::vector<double> planes_;  ///< by node number, as in BspPushView; only for that walk
  glm::dvec3 push_{0.0};
};

template <bool Any, class Real, class Visitor>
bool Bsp::walk(const WalkStart<Real>& start, const RaySetup<Real>& setup, Best<Real>& best,
               Visitor& visitor) const {
  using Integer = IntegerOf<Real>;
  const Real half(0.5);
  // For each axis the half that the ray enters first, and the other one.
  std::array<Integer, 3> near_half;
  std::array<Integer, 3> far_half;
  for (std::uint32_t a = 0; a < 3; ++a) {
    near_half[a] = (start.mask >> a) & 1U;
    far_half[a] = near_half[a] ^ 1U;
  }
  std::array<NodeSpan<Real>, stack_size> stack;
  std::size_t waiting = 0;
  NodeSpan<Real> now = start.root;
  for (;;) {
    const TopologyNode& record = topology_.nodes[now.node];
    if (record.leaf) {
      if (test_list<Any>(topology_, *triangles_, now.node, setup, best, visitor)) {
        return true;
      }
      if (!take_waiting(stack, waiting, best.t, start.slack, now)) {
        return false;
      }
      continue;
    }
    visitor.branch(now.node);
    const unsigned a = bsp_axis(record.level);
    const Integer first = record.first;
    const Real middle = (now.s0[a] + now.s1[a]) * half;
    if (middle <= now.in) {
      now.s0[a] = middle;
      now.node = plain(first + far_half[a]);
      continue;
    }
    if (middle < now.out) {
      NodeSpan<Real>& later = stack[waiting++];
      later = now;
      later.s0[a] = middle;
      later.in = middle;
      later.node = plain(first + far_half[a]);
      now.out = middle;
    }
    now.s1[a] = middle;
    now.node = plain(first + near_half[a]);
  }
}

/// The slow walk for rays from far away. True when an occlusion query found its hit.
template <bool Any, class Real, class Visitor>
bool Bsp::walk_far(const FarRay& far, std::uint32_t node, const glm::dvec3& lo, const glm::dvec3& hi,
                   const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
  if (!far.may_hit(far.span(lo, hi), plain(best.t))) {
    return false;
  }
  const TopologyNode& record = topology_.nodes[node];
  if (record.leaf) {
    return test_list<Any>(topology_, *triangles_, node, setup, best, visitor);
  }
  visitor.branch(node);
  const int a = static_cast<int>(bsp_axis(record.level));
  const std::uint32_t first = far.direction[static_cast<std::size_t>(a)] < 0.0 ? 1U : 0U;
  for (const std::uint32_t half : {first, first ^ 1U}) {
    glm::dvec3 child_lo = lo;
    glm::dvec3 child_hi = hi;
    (half != 0 ? child_lo : child_hi)[a] = 0.5 * (lo[a] + hi[a]);
    if (walk_far<Any>(far, record.first + half, child_lo, child_hi, setup, best, visitor)) {
      return true;
    }
  }
  return false;
}

/// Chooses the walk for one ray. True when an occlusion query found its hit.
template <bool Any, class Real, class Visitor>
bool Bsp::query(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
  begin_query(visitor);
  const WalkStart<Real> start = start_walk(frame_, ray, setup);
  if (start.far) [[unlikely]] {
    return !frame_.box.empty() && walk_far<Any>(FarRay(frame_, ray, std::is_same_v<Real, float>), 0U,
                                                frame_.box.lo, frame_.box.hi, setup, best, visitor);
  }
  if (!start.hits_root) {
    return false;
  }
  if (options_.walk == BspWalk::push_point) {
    return walk_bsp_push<Any>({&topology_, planes_.data(), triangles_.get(), &frame_, push_}, ray, start,
                              setup, best, visitor);
  }
  return walk<Any>(start, setup, best, visitor);
}

}  // namespace marti::accel
