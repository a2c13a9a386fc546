// The BSP tree's walk in Glassner's manner ("Space subdivision for fast ray tracing", IEEE CG&A 4(10), 1984;
// with Kaplan's binary tree, SIGGRAPH '85 course notes): from a leaf to the face the ray leaves it by, a
// point pushed past that face, and the next leaf found by descent from the root.
//
// Leaving a leaf takes the parameters of its six faces (six subtractions, six divisions), the least of the
// three far ones (three comparisons tell near from far, two find the least) and one addition that pushes the
// point past the face: 6 divisions, 7 additions, 5 comparisons. Beside these
//   - one comparison tells whether the walk ends,
//   - the point's two other coordinates take two multiplications and two additions, and two comparisons hold
//     them to where the ray has been,
//   - the descent takes one comparison a level, with the plane that each branch keeps.
//
// Why it finds every hit that brute force finds, bit for bit, and always ends (u, D, delta and the root box
// as in octree.h; "forwards" along an axis is the ray's direction):
//  1. On each axis `passed` is the coordinate the ray has been pushed to when it last left a leaf along that
//     axis. It only moves forwards, and the point that locates the next leaf is never behind it.
//  2. A leaf holds its point, so the face by which it is left along axis k lies at or beyond passed[k].
//     passed[k] is not in a plane: it is a plane plus half the smallest cell, which is 4 delta or more. So
//     each step takes passed[k] on by at least a whole smallest cell. A walk thus visits no leaf twice and
//     ends after 3 * 2^20 steps at most, whatever is rounded.
//  3. A plane's parameter is a subtraction and a division, both rounded, hence monotone in the plane, and the
//     same wherever the plane occurs. Let M be the largest parameter at which a leaf was left so far, at
//     first that of the entry into the root. A leaf is given the piece from the M before it to the M after
//     it. The pieces have no gaps. Let t be in a leaf's piece. Then t is at most the parameters of the leaf's
//     far faces. And it is at least that of any plane passed, and of any point used to locate the leaf, whose
//     coordinates lie beyond the leaf's near faces or less than half a smallest cell beyond a face passed. So
//     on every axis the ray at t is between the leaf's faces, but for the rounding of a parameter and of a
//     point: less than 4 * 128 u D < 2^-41 D. So the leaf whose piece holds a hit's parameter lists the
//     triangle.
//  4. The walk ends at the root's far faces, beyond t_max, or more than 4 delta beyond the best hit so far; a
//     hit is never refused for lying outside the leaf at hand.
//  Rays for which 3 does not hold (see far_ray.h) take the recursive walk's slow form.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <glm/vec3.hpp>

#include "accel/counted.h"
#include "accel/frame.h"
#include "accel/list_test.h"
#include "accel/octree_start.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/watertight.h"
#include "sim/error.h"

namespace marti::accel {

/// The axis across which nodes of a level are split.
[[nodiscard]] constexpr unsigned bsp_axis(unsigned level) { return (level - 1) % 3; }

/// What the walk reads, by reference.
struct BspPushView {
  const Topology* topology;
  const double* planes;  ///< the plane that splits each branch, by node number
  const TriangleSet* triangles;
  const RootFrame* frame;
  glm::dvec3 push;  ///< half the smallest cell
};

/// True when an occlusion query found its hit.
template <bool Any, class Real, class Visitor>
bool walk_bsp_push(const BspPushView& view, const Ray& ray, const WalkStart<Real>& start,
                   const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  using std::max;
  using std::min;
  using Integer = IntegerOf<Real>;
  struct Axis {
    Real origin;
    Real direction;  // never zero
    Real push;       // signed
    Real passed;
    Real point;
    double lo;  // of the root
    double hi;
    bool backwards;

    [[nodiscard]] Real parameter(Real plane) const { return (plane - origin) / direction; }
  };
  std::array<Axis, 3> axes;
  Real limit = start.root.out;
  for (std::uint32_t a = 0; a < 3; ++a) {
    Axis& axis = axes[a];
    const int k = static_cast<int>(a);
    axis.backwards = ((plain(start.mask) >> a) & 1U) != 0;
    axis.origin = Real(ray.origin[k]);
    // With slope 0 every plane except one through the origin counts as infinitely far.
    axis.direction = Real(ray.direction[k] == 0.0 ? std::numeric_limits<double>::min() : ray.direction[k]);
    axis.push = Real(axis.backwards ? -view.push[k] : view.push[k]);
    axis.lo = view.frame->box.lo[k];
    axis.hi = view.frame->box.hi[k];
    axis.passed = Real(axis.backwards ? axis.hi : axis.lo);
    axis.point = axis.origin + Real(ray.direction[k]) * start.root.in;
    limit = min(limit, axis.parameter(Real(axis.backwards ? axis.lo : axis.hi)));
  }
  Integer best_so_far = no_primitive;
  for (std::uint32_t steps = 3U << 20U; steps-- > 0;) {
    // Find the leaf that holds the point, and its faces.
    std::array<double, 3> lo{axes[0].lo, axes[1].lo, axes[2].lo};
    std::array<double, 3> hi{axes[0].hi, axes[1].hi, axes[2].hi};
    std::uint32_t node = 0;
    for (;;) {
      const TopologyNode& record = view.topology->nodes[node];
      if (record.leaf) {
        break;
      }
      visitor.branch(node);
      const unsigned a = bsp_axis(record.level);
      const double plane = view.planes[node];
      if (Real(plane) <= axes[a].point) {
        lo[a] = plane;
        node = plain(Integer(record.first) + Integer(1U));
      } else {
        hi[a] = plane;
        node = record.first;
      }
    }
    if (test_list<Any>(*view.topology, *view.triangles, node, setup, best, visitor)) {
      return true;
    }
    if (!(best_so_far == Integer(best.primitive))) {
      best_so_far = best.primitive;
      limit = min(limit, best.t + start.slack);
    }
    std::array<Real, 3> until;
    for (std::uint32_t a = 0; a < 3; ++a) {
      until[a] = max(axes[a].parameter(Real(lo[a])), axes[a].parameter(Real(hi[a])));
    }
    // On ties x comes before y, and y before z.
    std::uint32_t exit = until[0] <= until[1] ? 0U : 1U;
    if (!(until[exit] <= until[2])) {
      exit = 2U;
    }
    const Real out = until[exit];
    if (!(out < limit)) {
      return false;
    }
    for (std::uint32_t a = 0; a < 3; ++a) {
      Axis& axis = axes[a];
      if (a == exit) {
        axis.point = axis.passed = Real(axis.backwards ? lo[a] : hi[a]) + axis.push;
      } else {
        axis.point = axis.origin + Real(ray.direction[static_cast<int>(a)]) * out;
        axis.point = axis.backwards ? min(axis.point, axis.passed) : max(axis.point, axis.passed);
      }
    }
  }
  throw sim::InternalError("a walk through a BSP tree did not end");
}

}  // namespace marti::accel
