// How a ray enters the root of the octree: the beginning of all walks except the slow one.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "accel/counted.h"
#include "accel/octree_nodes.h"
#include "accel/ray.h"
#include "accel/watertight.h"

namespace marti::accel {

/// The ray's parameters at one node: at its nearer (s0) and farther (s1) planes along each axis, and where
/// the ray enters and leaves the node.
template <class Real>
struct NodeSpan {
  std::array<Real, 3> s0;
  std::array<Real, 3> s1;
  Real in;
  Real out;
  std::uint32_t node = 0;
};

/// The state of a ray at the root.
template <class Real>
struct WalkStart {
  NodeSpan<Real> root;
  IntegerOf<Real> mask = 0U;    ///< bit a: the direction is negative along axis a
  Real slack{0.0};              ///< 4 delta as a parameter
  std::array<Real, 3> inverse;  ///< 1 / |direction component|, at most RootFrame::largest_inverse
  bool hits_root = false;
  bool far = false;  ///< take the slow walk instead; the other members are not set
};

template <class Real>
[[nodiscard]] inline WalkStart<Real> start_walk(const RootFrame& frame, const Ray& ray,
                                                const RaySetup<Real>& setup) {
  using std::abs;
  using std::max;
  using std::min;
  WalkStart<Real> start;
  if constexpr (std::is_same_v<Real, float>) {
    start.far = true;  // the cells' margins are too thin for the error of floats
    return start;
  }
  const std::array<Real, 3> o{Real(ray.origin.x), Real(ray.origin.y), Real(ray.origin.z)};
  const std::array<Real, 3> d{Real(ray.direction.x), Real(ray.direction.y), Real(ray.direction.z)};
  const std::array<double, 3> lo{frame.box.lo.x, frame.box.lo.y, frame.box.lo.z};
  const std::array<double, 3> hi{frame.box.hi.x, frame.box.hi.y, frame.box.hi.z};
  const Real scale = abs(setup.scale);
  start.far = !(abs(o[0] - Real(frame.center.x)) <= Real(frame.far)) ||
              !(abs(o[1] - Real(frame.center.y)) <= Real(frame.far)) ||
              !(abs(o[2] - Real(frame.center.z)) <= Real(frame.far)) || !(scale <= Real(0x1p500)) ||
              !(scale >= Real(0x1p-500));
  if (start.far) [[unlikely]] {
    return start;
  }
  start.slack = scale * Real(4.0 * frame.delta);
  NodeSpan<Real>& root = start.root;
  for (std::uint32_t a = 0; a < 3; ++a) {
    // A zero component, of either sign, gives the cap: the planes' parameters are then huge, with the right
    // sign, and so is the average of two.
    const Real inverse = min(Real(1.0) / abs(d[a]), Real(frame.largest_inverse));
    start.inverse[a] = inverse;
    if (d[a] < Real(0.0)) {
      start.mask = start.mask | (1U << a);
      root.s0[a] = (o[a] - Real(hi[a])) * inverse;
      root.s1[a] = (o[a] - Real(lo[a])) * inverse;
    } else {
      root.s0[a] = (Real(lo[a]) - o[a]) * inverse;
      root.s1[a] = (Real(hi[a]) - o[a]) * inverse;
    }
  }
  root.in = max(max(max(root.s0[0], root.s0[1]), root.s0[2]), setup.t_min - start.slack);
  root.out = min(min(min(root.s1[0], root.s1[1]), root.s1[2]), setup.t_max + start.slack);
  start.hits_root = root.in <= root.out;
  return start;
}

/// For each outcome of the comparisons mx <= my, my <= mz, mx <= mz (bits 0 to 2): the axes in the order of
/// their mid-planes, two bits each; on ties x comes before y, and y before z. Outcomes 3 and 4 are
/// contradictory and do not occur.
inline constexpr std::array<std::uint8_t, 8> plane_order = [] {
  std::array<std::uint8_t, 8> table{};
  for (unsigned bits = 0; bits < 8; ++bits) {
    const bool xy = (bits & 1U) != 0;
    const bool yz = (bits & 2U) != 0;
    const bool xz = (bits & 4U) != 0;
    const unsigned rank_x = (xy ? 0U : 1U) + (xz ? 0U : 1U);
    const unsigned rank_y = (xy ? 1U : 0U) + (yz ? 0U : 1U);
    const unsigned rank_z = (xz ? 1U : 0U) + (yz ? 1U : 0U);
    table[bits] =
        static_cast<std::uint8_t>((1U << (2 * rank_y)) | (2U << (2 * rank_z)) | (0U << (2 * rank_x)));
  }
  return table;
}();

/// Takes the span on top of the stack. False when the walk is over: the stack is empty, or this span, and so
/// all below it, begins more than `slack` beyond the best hit at `best_t`.
template <class Real, class Span, std::size_t Size>
[[nodiscard]] inline bool take_waiting(const std::array<Span, Size>& stack, std::size_t& waiting,
                                       const Real& best_t, const Real& slack, Span& now) {
  if (waiting == 0) {
    return false;
  }
  now = stack[--waiting];
  return !(now.in > best_t + slack);
}

/// At most three siblings a level wait.
inline constexpr std::size_t walk_stack_size = std::size_t{3} * 21 + 1;

}  // namespace marti::accel
