// The uniform grid: Fujimoto's and Amanatides and Woo's incremental walk ("A Fast Voxel Traversal Algorithm
// for Ray Tracing", Eurographics 1987; Cleary and Wyvill, "Analysis of an algorithm for fast ray tracing
// using uniform space subdivision", The Visual Computer 4, 1988), with the one change that nothing is
// accumulated: the parameter at a plane comes from the plane's number, by one formula.
//
// Why it finds every hit that brute force finds, bit for bit (u, D, delta and the root box as in octree.h):
//  1. A cell lists every triangle that meets the cell enlarged on all sides by delta. Neighbours share the
//     very same plane, which is computed from its integer number.
//  2. An accepted hit at t has the ray's point at t within 2^-41 D of the triangle, hence inside the root
//     box, hence t is between the parameters at which the ray enters and leaves the box.
//  3. Along each axis the computed parameter of the planes never decreases with their number: a subtraction
//     and a multiplication by one positive number, both rounded, are monotone. The start cell is moved until
//     the entry lies between the computed parameters of its planes, and each step goes to the cell beyond the
//     nearest next plane. So the pieces of the ray have no gaps, and on every axis a cell's piece lies
//     between the computed parameters of the cell's planes. Each of these errs by less than 4 * 128 u D <
//     2^-41 D as a distance. So the cell whose piece holds a hit's parameter lists the triangle.
//  4. The walk ends when a cell begins more than 4 delta (as a distance along the ray) beyond the best hit so
//     far, and a hit is never refused for lying outside the cell at hand.
//  Each step raises or lowers one cell number, so no walk has more than nx + ny + nz steps.
//  Rays for which 3 does not hold (see far_ray.h) test the boxes of slices, rows and cells, enlarged by the
//  ray's own error, in a slower walk.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <type_traits>
#include <vector>

#include "accel/far_ray.h"
#include "accel/frame.h"
#include "accel/list_test.h"
#include "accel/mailbox.h"
#include "accel/octree_start.h"
#include "accel/queries.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/visitor.h"
#include "accel/watertight.h"
#include "sim/error.h"
#include "sim/memory_budget.h"

namespace marti::accel {

struct GridOptions {
  /// About so many cells for each triangle; the cells are as near to cubes as whole numbers allow. Above 0,
  /// up to 2^20.
  double density = 4.0;
  /// Cells along x, y and z; if one is 0 all three follow from the density. Up to 2^20 each.
  std::array<std::uint32_t, 3> resolution{0, 0, 0};
  /// The most cells; a resolution with more is lowered. From 1 to 2^27.
  std::uint64_t max_cells = std::uint64_t{1} << 22;
  /// The resolution is halved until the cells list at most this many triangles in all; it bounds the memory
  /// of hostile scenes (4 bytes an entry). At least 1.
  std::uint64_t max_entries = std::uint64_t{1} << 25;
  /// The host memory for the grid and its building; if more is needed, a UserError is thrown.
  sim::MemoryBudget memory{};
};

/// The topology: node 0, the grid's header, is a branch, and its children are all cells as leaves: cell (x,
/// y, z) is node 1 + x + nx (y + ny z). Without triangles node 0 is an empty leaf. A walk visits the header
/// once and then the cells on the ray, front to back, empty cells included.
class Grid : public Queries<Grid> {
 public:
  static constexpr std::string_view kind_name = "grid";

  /// Throws UserError when an option is out of range. Besides the limits of the options, cells are at least 8
  /// delta thick, so a scene that is flat along an axis has few cells along it, or one.
  [[nodiscard]] static Grid build(std::shared_ptr<const TriangleSet> triangles,
                                  const GridOptions& options = {});

  [[nodiscard]] const Topology& topology() const { return topology_; }
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  [[nodiscard]] const GridOptions& options() const { return options_; }
  [[nodiscard]] const scenes::Bounds& bounds() const { return frame_.box; }
  [[nodiscard]] double delta() const { return frame_.delta; }
  /// The resolution that the options ask for, before the limits lower it.
  [[nodiscard]] const std::array<std::uint32_t, 3>& requested() const { return requested_; }
  /// Cells along x, y and z; all 0 without triangles.
  [[nodiscard]] const std::array<std::uint32_t, 3>& resolution() const { return resolution_; }
  /// Plane `i` of an axis, from 0 to the resolution.
  [[nodiscard]] double plane(unsigned axis, std::uint32_t i) const { return planes_[axis][i]; }

 private:
  friend class Queries<Grid>;
  Grid() = default;

  template <bool Any, class Real, class Visitor>
  bool query(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const;
  template <bool Any, class Real, class Visitor>
  bool walk(const Ray& ray, const WalkStart<Real>& start, const RaySetup<Real>& setup, Best<Real>& best,
            Visitor& visitor) const;
  template <bool Any, class Real, class Visitor>
  bool walk_far(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const;
  /// The position of a coordinate along an axis of the box, in cells; cell_at() gives its cell.
  template <class Real>
  [[nodiscard]] Real share_along(unsigned axis, Real position) const {
    const int a = static_cast<int>(axis);
    return (position - Real(frame_.box.lo[a])) * Real(cells_per_length_[axis]);
  }
  [[nodiscard]] std::uint32_t cell_at(unsigned axis, double cells) const;

  std::shared_ptr<const TriangleSet> triangles_;
  GridOptions options_;
  RootFrame frame_;
  Topology topology_;
  std::array<std::uint32_t, 3> requested_{0, 0, 0};
  std::array<std::uint32_t, 3> resolution_{0, 0, 0};
  std::array<double, 3> cells_per_length_{0.0, 0.0, 0.0};
  std::array<std::vector<double>, 3> planes_;
};

template <bool Any, class Real, class Visitor>
bool Grid::walk(const Ray& ray, const WalkStart<Real>& start, const RaySetup<Real>& setup, Best<Real>& best,
                Visitor& visitor) const {
  using std::abs;
  using std::max;
  using std::min;
  using Integer = IntegerOf<Real>;
  struct Axis {
    const double* planes;
    Real origin;
    Real inverse;    // as in start_walk
    Integer next;    // number of the plane by which the cell is left
    Integer last;    // number of the plane beyond which there is no cell
    Integer step;    // +1 or -1, modulo 2^32
    Integer stride;  // the step's change of the node number
    bool negative;

    [[nodiscard]] Real at(std::uint32_t i) const {
      const Real distance = negative ? origin - Real(planes[i]) : Real(planes[i]) - origin;
      return distance * inverse;
    }
  };
  std::array<Axis, 3> axes;
  std::array<Real, 3> until;
  Integer node = 1U;
  const Real in = start.root.in;
  Integer stride = 1U;
  for (std::uint32_t a = 0; a < 3; ++a) {
    Axis& axis = axes[a];
    const int k = static_cast<int>(a);
    const std::uint32_t n = resolution_[a];
    axis.planes = planes_[a].data();
    axis.origin = Real(ray.origin[k]);
    axis.inverse = min(Real(1.0) / abs(Real(ray.direction[k])), Real(frame_.largest_inverse));
    axis.negative = ((plain(start.mask) >> a) & 1U) != 0;
    const Real guess = share_along(a, Real(ray.origin[k]) + Real(ray.direction[k]) * in);
    const Integer side = axis.negative ? 0U : 1U;  // from a cell to the plane by which it is left
    const Integer back = axis.negative ? 1U : 0U;  // and to the plane by which it is entered
    Integer cell = cell_at(a, plain(guess));
    axis.step = axis.negative ? 0xffffffffU : 1U;
    const Integer first = axis.negative ? n - 1 : 0U;
    const Integer last = axis.negative ? 0U : n - 1;
    axis.stride = axis.negative ? Integer(0U) - stride : stride;
    while (!(cell == first) && axis.at(plain(cell + back)) > in) {
      cell = cell - axis.step;
    }
    while (!(cell == last) && axis.at(plain(cell + side)) < in) {
      cell = cell + axis.step;
    }
    axis.next = cell + side;
    axis.last = last + side;
    until[a] = axis.at(plain(axis.next));
    node = node + cell * stride;
    stride = stride * Integer(n);
  }
  Real limit = start.root.out;
  Integer best_so_far = no_primitive;
  visitor.branch(0);
  for (std::uint32_t steps = resolution_[0] + resolution_[1] + resolution_[2] + 3; steps-- > 0;) {
    if (test_list<Any>(topology_, *triangles_, plain(node), setup, best, visitor)) {
      return true;
    }
    if (!(best_so_far == Integer(best.primitive))) {
      best_so_far = best.primitive;
      limit = min(limit, best.t + start.slack);
    }
    // On ties x comes before y, and y before z.
    std::uint32_t a = until[0] <= until[1] ? 0U : 1U;
    if (!(until[a] <= until[2])) {
      a = 2U;
    }
    Axis& axis = axes[a];
    if (axis.next == axis.last || !(until[a] < limit)) {
      return false;
    }
    axis.next = axis.next + axis.step;
    node = node + axis.stride;
    until[a] = axis.at(plain(axis.next));
  }
  throw sim::InternalError("a walk through a grid did not end");
}

template <bool Any, class Real, class Visitor>
bool Grid::walk_far(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
  if (frame_.box.empty()) {
    return false;
  }
  const FarRay far(frame_, ray, std::is_same_v<Real, float>);
  glm::dvec3 lo = frame_.box.lo;
  glm::dvec3 hi = frame_.box.hi;
  const auto met = [&] { return far.may_hit(far.span(lo, hi), plain(best.t)); };
  if (!met()) {
    return false;
  }
  visitor.branch(0);
  const std::array<std::uint32_t, 3> strides{1U, resolution_[0], resolution_[0] * resolution_[1]};
  // Slices across the ray's main axis, rows of a slice, cells of a row, all in the ray's direction.
  const std::array<unsigned, 3> order{setup.kz, setup.kx, setup.ky};
  const auto narrow = [&](unsigned axis, std::uint32_t k) {
    const int a = static_cast<int>(axis);
    const std::uint32_t i = ray.direction[a] < 0.0 ? resolution_[axis] - 1 - k : k;
    lo[a] = planes_[axis][i];
    hi[a] = planes_[axis][i + 1];
    return i * strides[axis];
  };
  const auto widen = [&](unsigned axis) {
    const int a = static_cast<int>(axis);
    lo[a] = frame_.box.lo[a];
    hi[a] = frame_.box.hi[a];
  };
  for (std::uint32_t i = 0; i < resolution_[order[0]]; ++i) {
    const std::uint32_t slice = 1U + narrow(order[0], i);
    for (std::uint32_t j = 0; met() && j < resolution_[order[1]]; ++j) {
      const std::uint32_t row = slice + narrow(order[1], j);
      for (std::uint32_t k = 0; met() && k < resolution_[order[2]]; ++k) {
        const std::uint32_t node = row + narrow(order[2], k);
        if (met() && test_list<Any>(topology_, *triangles_, node, setup, best, visitor)) {
          return true;
        }
        widen(order[2]);
      }
      widen(order[1]);
    }
  }
  return false;
}

/// Chooses the walk for one ray. True when an occlusion query found its hit.
template <bool Any, class Real, class Visitor>
bool Grid::query(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
  begin_query(visitor);
  const WalkStart<Real> start = start_walk(frame_, ray, setup);
  if (start.far) [[unlikely]] {
    return walk_far<Any>(ray, setup, best, visitor);
  }
  if (!start.hits_root) {
    return false;
  }
  return walk<Any>(ray, start, setup, best, visitor);
}

}  // namespace marti::accel
