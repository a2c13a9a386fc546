// The voxel cut: a walk of the octree that does not enter a cell whose projection on the screen is smaller
// than a pixel, but takes the cell as one voxel. An approximation, after the voxel antialiasing of R. Shah
// (DPhil thesis, University of Sussex) as used by McNeill, Shah, Hebert, Lister, Grimsdale, CGF 11(4), 1992.
//
// When a cell is small. The root with edges e, seen along the unit direction d, covers
//     P = e_y e_z |d_x| + e_x e_z |d_y| + e_x e_y |d_z|
// across the ray, and a cell of level l P / 4^(l-1). Cells need not be cubes: a flat one seen from its edge
// covers little but is many pixels long, so the square of the longest edge is taken where that is more. A
// pixel of solid angle w covers w z^2 at the distance z, measured along the ray and all the rays before it
// back to the eye. The cell is small when, at the point where the ray enters it,
//     max(P, longest^2) / 4^(l-1) < threshold * w * z^2.
//
// What happens at a small cell. The share of it that its surfaces cover, seen along the ray, is estimated
// (voxel_cover.h). With a quarter or more the ray ends: the whole cell is opaque. Else the walk enters the
// cell as usual, so no ray slips through a surface in the corners of cells, and a cell that holds only a
// corner of a surface does not become a brick. Surfaces thus appear up to one cell too thick. A cell in which
// a triangle listed in an earlier cell was already hit is not taken whole.
//
// For a ray that left a surface, no cell is taken whole that holds the ray's origin or is nearer than four of
// the cell's diagonals, as the surface passes through those. On a flat surface parallel to a cell face, rays
// that stay longer in its cells are so oblique that it covers less than a quarter.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "accel/octree.h"
#include "accel/voxel_cover.h"

namespace marti::accel {

inline constexpr std::uint32_t no_voxel = 0xffffffffU;

/// Edge lengths of a level's cells relative to those of the root: 2^(1 - level).
inline constexpr std::array<double, 22> level_scale = [] {
  std::array<double, 22> scale{2.0};
  for (std::size_t level = 1; level < scale.size(); ++level) {
    scale[level] = 0.5 * scale[level - 1];
  }
  return scale;
}();

/// A small cell whose surfaces cover a smaller share is not taken whole.
inline constexpr double least_covered_share = 0.25;

/// The size of a pixel along a ray of unit direction.
struct Footprint {
  double pixel = 0.0;  ///< solid angle below which a cell is taken whole: threshold times a pixel's; above 0
  double path = 0.0;   ///< length of the rays from the eye to this ray's origin; 0 for a camera ray
};

/// The voxels of a tree, by reference. Every node from `first_node` on, except empty leaves, has one.
struct VoxelTable {
  const std::uint32_t* voxel_of = nullptr;  ///< [node - first_node]: its voxel, or no_voxel
  const VoxelCover* covers = nullptr;       ///< [voxel]
  std::uint32_t first_node = 0;             ///< the first node of the first level that can be small
  std::uint32_t first_record = 0;           ///< visitors are told first_record + voxel
};

/// What a ray sees: a triangle, a voxel, or neither.
struct CutHit {
  Hit hit;
  std::uint32_t voxel = no_voxel;
  double t = 0.0;  ///< where the ray enters the voxel

  [[nodiscard]] bool found() const { return hit.found() || voxel != no_voxel; }
};

/// The state of the cut for one ray.
template <class Real>
class CutRay {
 public:
  CutRay(const RootFrame& frame, const Ray& ray, const Footprint& footprint, const VoxelTable& voxels)
      : path_(footprint.path), t_min_(ray.t_min), voxels_(voxels) {
    using std::abs;
    using std::max;
    using std::sqrt;
    const std::array<Real, 3> d{Real(ray.direction.x), Real(ray.direction.y), Real(ray.direction.z)};
    const glm::dvec3 e = frame.box.hi - frame.box.lo;
    const Real projection =
        abs(d[0]) * Real(e.y * e.z) + abs(d[1]) * Real(e.x * e.z) + abs(d[2]) * Real(e.x * e.y);
    const double longest = std::max({e.x, e.y, e.z});
    limit_ = sqrt(max(projection, Real(longest * longest)) / Real(footprint.pixel));
    clearance_ = Real(footprint.path > 0.0 ? 4.0 * std::hypot(e.x, e.y, e.z) : 0.0);
    share_ = Real(longest * longest) / projection;
    products_ = products_of(d);
  }

  /// Whether a node of `level`, which the ray enters at `in`, is small.
  [[nodiscard]] bool small(std::uint32_t node, unsigned level, const Real& in) const {
    const Real shrink(level_scale[level]);
    return node >= voxels_.first_node && path_ + in > limit_ * shrink && in > t_min_ &&
           in >= clearance_ * shrink;
  }

  /// Whether the ray sees this small node, which is not an empty leaf, as a voxel.
  template <class Visitor>
  [[nodiscard]] bool sees(std::uint32_t node, double in, Visitor& visitor) {
    const std::uint32_t voxel = voxels_.voxel_of[node - voxels_.first_node];
    if (voxels_.covers[voxel].seen(products_) * share_ >= Real(least_covered_share)) {
      visitor.cut(node);
      seen_.voxel = voxel;
      seen_.t = in;
      return true;
    }
    visitor.pass(voxels_.first_record + voxel);
    return false;
  }

  /// The result for the ray, given the nearest triangle found.
  [[nodiscard]] CutHit result(const Best<Real>& best) const {
    CutHit hit = seen_;
    if (hit.voxel == no_voxel) {
      hit.hit = best.hit();
    }
    return hit;
  }

 private:
  Real path_;
  Real t_min_;
  Real limit_;      // path length from which on the root itself would be small
  Real clearance_;  // t from which on the root itself may be taken whole
  Real share_;      // longest^2 / P
  SymmetricForm<Real> products_;
  CutHit seen_;
  const VoxelTable& voxels_;
};

/// NodeSpan with the node's level.
template <class Real>
struct CutSpan : NodeSpan<Real> {
  unsigned level = 1;
};

/// The walk of octree_walk.h with the cut. It ends at the first voxel seen, or with the nearest triangle.
template <class Real, class Visitor>
void walk_octree_cut(const OctreeView& view, const WalkStart<Real>& start, const RaySetup<Real>& setup,
                     CutRay<Real>& cut, Best<Real>& best, Visitor& visitor) {
  std::array<CutSpan<Real>, walk_stack_size> stack;
  std::size_t waiting = 0;
  CutSpan<Real> now{start.root, 1};
  for (;;) {
    const OctreeNode record = view.nodes[now.node];
    if (record.info != OctreeNode::leaf_bit && cut.small(now.node, now.level, now.in) &&
        !(best.found() && best.t <= now.out) && cut.sees(now.node, plain(now.in), visitor)) {
      return;
    }
    if (record.leaf()) {
      test_leaf<false>(view, record, now.node, setup, best, visitor);
      if (!take_waiting(stack, waiting, best.t, start.slack, now)) {
        return;
      }
      continue;
    }
    visitor.branch(now.node);
    now = enter_children<Real>(now, record.first, start.mask, stack, waiting);
  }
}

/// One node of the slow walk of octree_far.h with the cut. True when the walk is over.
template <class Real, class Visitor>
bool walk_far_cut_node(const OctreeView& view, const FarRay& far, std::uint32_t node, unsigned level,
                       const FarSpan& within, const glm::dvec3& lo, const glm::dvec3& hi,
                       const RaySetup<Real>& setup, CutRay<Real>& cut, Best<Real>& best, Visitor& visitor) {
  const OctreeNode record = view.nodes[node];
  if (record.info != OctreeNode::leaf_bit && cut.small(node, level, Real(within.in)) &&
      !(best.found() && plain(best.t) <= within.out) && cut.sees(node, within.in, visitor)) {
    return true;
  }
  if (record.leaf()) {
    return test_leaf<false>(view, record, node, setup, best, visitor);
  }
  visitor.branch(node);
  struct Met {
    FarSpan span;
    std::uint32_t child;
    glm::dvec3 lo;
    glm::dvec3 hi;
  };
  const glm::dvec3 mid = 0.5 * (lo + hi);
  std::array<Met, 8> met;
  std::size_t count = 0;
  for (std::uint32_t child = 0; child < 8; ++child) {
    Met one{{}, child, lo, hi};
    for (int a = 0; a < 3; ++a) {
      (((child >> a) & 1U) != 0 ? one.lo : one.hi)[a] = mid[a];
    }
    one.span = far.span(one.lo, one.hi);
    if (one.span.in <= one.span.out && one.span.out >= far.t_min - far.slack) {
      std::size_t at = count++;
      for (; at > 0 && met[at - 1].span.in > one.span.in; --at) {
        met[at] = met[at - 1];
      }
      met[at] = one;
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (met[k].span.in > plain(best.t) + far.slack) {
      return false;
    }
    if (walk_far_cut_node(view, far, record.first + met[k].child, level + 1, met[k].span, met[k].lo,
                          met[k].hi, setup, cut, best, visitor)) {
      return true;
    }
  }
  return false;
}

/// An octree with voxels. Keeps references; immutable.
class CutOctree {
 public:
  CutOctree(const Octree& octree, const VoxelTable& voxels) : octree_(octree), voxels_(voxels) {}
  [[nodiscard]] const TriangleSet& triangles() const { return octree_.triangles(); }

  /// What a ray of unit direction sees. With a pixel size near 0, the octree's nearest hit.
  template <class Real = double, class Visitor>
  [[nodiscard]] CutHit closest(const Ray& ray, const Footprint& footprint, Visitor& visitor) const {
    const OctreeView view = octree_.view();
    const RaySetup<Real> setup(ray);
    Best<Real> best(setup);
    begin_query(visitor);
    const WalkStart<Real> start = start_walk(*view.frame, ray, setup);
    CutRay<Real> cut(*view.frame, ray, footprint, voxels_);
    if (start.far) [[unlikely]] {
      const scenes::Bounds& box = view.frame->box;
      if (!box.empty()) {
        const FarRay far(*view.frame, ray, std::is_same_v<Real, float>);
        const FarSpan span = far.span(box.lo, box.hi);
        if (far.may_hit(span, plain(best.t))) {
          walk_far_cut_node(view, far, 0U, 1U, span, box.lo, box.hi, setup, cut, best, visitor);
        }
      }
    } else if (start.hits_root) {
      walk_octree_cut(view, start, setup, cut, best, visitor);
    }
    return cut.result(best);
  }

  /// Whether any triangle is hit: occlusion is never cut.
  template <class Real = double, class Visitor>
  [[nodiscard]] bool occluded(const Ray& ray, Visitor& visitor) const {
    return octree_.occluded<Real>(ray, visitor);
  }

  [[nodiscard]] const Octree& octree() const { return octree_; }

 private:
  const Octree& octree_;
  const VoxelTable& voxels_;
};

}  // namespace marti::accel
