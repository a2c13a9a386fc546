// The walk of octree_walk.h for doubles on machines with AVX2: the three axes of a node in one vector, four
// triangles of a leaf at a time. Each lane does the same operations in the same order, so visits and hits are
// the same, bit for bit.
#pragma once

#include "sim/avx2.h"

#ifdef MARTI_AVX2

#include <immintrin.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "accel/intersect.h"
#include "accel/octree_nodes.h"
#include "accel/octree_start.h"
#include "accel/ray.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// A waiting node: NodeSpan with its axes in vectors (the fourth lane is not used).
struct VectorSpan {
  __m256d s0;
  __m256d s1;
  double in;
  double out;
  std::uint32_t node;
};

/// Lane a is all ones when bit a is set.
struct alignas(32) LaneMasks {
  std::array<std::array<std::uint64_t, 4>, 8> lanes;
};
inline constexpr LaneMasks lane_masks = [] {
  LaneMasks masks{};
  for (unsigned bits = 0; bits < 8; ++bits) {
    for (unsigned a = 0; a < 3; ++a) {
      masks.lanes[bits][a] = ((bits >> a) & 1U) != 0 ? ~std::uint64_t{0} : 0U;
    }
  }
  return masks;
}();

/// crossing_order[outcome][crossed]: the crossed axes in the order of plane_order, two bits each.
inline constexpr std::array<std::array<std::uint8_t, 8>, 8> crossing_order = [] {
  std::array<std::array<std::uint8_t, 8>, 8> table{};
  for (unsigned outcome = 0; outcome < 8; ++outcome) {
    for (unsigned crossed = 0; crossed < 8; ++crossed) {
      unsigned packed = 0;
      unsigned count = 0;
      for (unsigned k = 0; k < 3; ++k) {
        const unsigned a = (plane_order[outcome] >> (2 * k)) & 3U;
        if (((crossed >> a) & 1U) != 0 && count < 3) {
          packed |= a << (2 * count++);
        }
      }
      table[outcome][crossed] = static_cast<std::uint8_t>(packed);
    }
  }
  return table;
}();

/// One ray's constants in all lanes.
struct VectorRay {
  __m256d origin_x;
  __m256d origin_y;
  __m256d origin_z;
  __m256d shear_x;
  __m256d shear_y;
};

[[gnu::target("avx2"), gnu::always_inline]] inline __m256d load_lanes(const TrianglePack& pack,
                                                                      unsigned coordinate) {
  return _mm256_load_pd(pack.coordinate[coordinate].data());
}

/// The kernel's values for four triangles, up to the sign test, lane by lane.
struct alignas(32) PackEdges {
  std::array<double, 4> u;
  std::array<double, 4> v;
  std::array<double, 4> w;
  std::array<double, 4> det;
  std::array<double, 4> products;
  std::array<double, 4> depth_a;
  std::array<double, 4> depth_b;
  std::array<double, 4> depth_c;
};

[[gnu::target("avx2"), gnu::always_inline]] inline __m256d shear(__m256d x, __m256d origin, __m256d slope,
                                                                 __m256d z) {
  return _mm256_sub_pd(_mm256_sub_pd(x, origin), _mm256_mul_pd(slope, z));
}

[[gnu::target("avx2"), gnu::always_inline]] inline __m256d magnitude(__m256d x) {
  return _mm256_andnot_pd(_mm256_set1_pd(-0.0), x);
}

/// The lanes of a pack, as bits, that the sign test does not refuse. `edges` is written if there are any.
[[gnu::target("avx2"), gnu::always_inline]] inline unsigned pack_candidates(const TrianglePack& pack,
                                                                            const RaySetup<double>& setup,
                                                                            const VectorRay& ray,
                                                                            PackEdges& edges) {
  const unsigned kx = setup.kx;
  const unsigned ky = setup.ky;
  const unsigned kz = setup.kz;
  const __m256d az = _mm256_sub_pd(load_lanes(pack, kz), ray.origin_z);
  const __m256d bz = _mm256_sub_pd(load_lanes(pack, 3 + kz), ray.origin_z);
  const __m256d cz = _mm256_sub_pd(load_lanes(pack, 6 + kz), ray.origin_z);
  const __m256d ax = shear(load_lanes(pack, kx), ray.origin_x, ray.shear_x, az);
  const __m256d ay = shear(load_lanes(pack, ky), ray.origin_y, ray.shear_y, az);
  const __m256d bx = shear(load_lanes(pack, 3 + kx), ray.origin_x, ray.shear_x, bz);
  const __m256d by = shear(load_lanes(pack, 3 + ky), ray.origin_y, ray.shear_y, bz);
  const __m256d cx = shear(load_lanes(pack, 6 + kx), ray.origin_x, ray.shear_x, cz);
  const __m256d cy = shear(load_lanes(pack, 6 + ky), ray.origin_y, ray.shear_y, cz);
  const __m256d cx_by = _mm256_mul_pd(cx, by);
  const __m256d cy_bx = _mm256_mul_pd(cy, bx);
  const __m256d ax_cy = _mm256_mul_pd(ax, cy);
  const __m256d ay_cx = _mm256_mul_pd(ay, cx);
  const __m256d bx_ay = _mm256_mul_pd(bx, ay);
  const __m256d by_ax = _mm256_mul_pd(by, ax);
  const __m256d u = _mm256_sub_pd(cx_by, cy_bx);
  const __m256d v = _mm256_sub_pd(ax_cy, ay_cx);
  const __m256d w = _mm256_sub_pd(bx_ay, by_ax);
  // A NaN among the three can make a sign go unseen, but never create one.
  const __m256d zero = _mm256_setzero_pd();
  const __m256d least = _mm256_min_pd(_mm256_min_pd(u, v), w);
  const __m256d most = _mm256_max_pd(_mm256_max_pd(u, v), w);
  const __m256d refused =
      _mm256_and_pd(_mm256_cmp_pd(least, zero, _CMP_LT_OQ), _mm256_cmp_pd(most, zero, _CMP_GT_OQ));
  const unsigned candidates = static_cast<unsigned>(_mm256_movemask_pd(refused)) ^ 15U;
  if (candidates != 0) {
    _mm256_store_pd(edges.u.data(), u);
    _mm256_store_pd(edges.v.data(), v);
    _mm256_store_pd(edges.w.data(), w);
    _mm256_store_pd(edges.det.data(), _mm256_add_pd(_mm256_add_pd(u, v), w));
    const __m256d first = _mm256_add_pd(magnitude(cx_by), magnitude(cy_bx));
    const __m256d second = _mm256_add_pd(magnitude(ax_cy), magnitude(ay_cx));
    const __m256d third = _mm256_add_pd(magnitude(bx_ay), magnitude(by_ax));
    _mm256_store_pd(edges.products.data(), _mm256_add_pd(_mm256_add_pd(first, second), third));
    _mm256_store_pd(edges.depth_a.data(), az);
    _mm256_store_pd(edges.depth_b.data(), bz);
    _mm256_store_pd(edges.depth_c.data(), cz);
  }
  return candidates;
}

/// The rest of the kernel for one lane. Special cases (slivers, zero areas, and NaN, the coordinates of
/// primitives other than triangles) are computed by the scalar kernels.
inline bool finish_lane(const OctreeView& view, const RaySetup<double>& setup, const PackEdges& edges,
                        std::uint32_t lane, std::uint32_t id, Best<double>& best) {
  const double det = edges.det[lane];
  if (!(std::abs(det) >= sliver_share * edges.products[lane]) || det == 0.0) [[unlikely]] {
    return intersect_primitive(setup, *view.triangles, id, best);
  }
  return accept<false>(setup, {edges.u[lane], edges.v[lane], edges.w[lane]}, det, edges.depth_a[lane],
                       edges.depth_b[lane], edges.depth_c[lane], id, best);
}

/// test_leaf on packs.
template <bool Any, class Visitor>
[[gnu::target("avx2"), gnu::always_inline]] inline bool test_packs(
    const OctreeView& view, const OctreeNode& record, std::uint32_t node, const RaySetup<double>& setup,
    const VectorRay& ray, Best<double>& best, Visitor& visitor) {
  const std::uint32_t entries = record.entries();
  PackEdges edges;
  for (std::uint32_t begin = 0; begin < entries; begin += 4) {
    const TrianglePack& pack = view.packs[record.first + begin / 4];
    for (unsigned left = pack_candidates(pack, setup, ray, edges); left != 0; left &= left - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(left));
      const std::uint32_t id = pack.id[lane];
      const bool hit = finish_lane(view, setup, edges, lane, id, best);
      if constexpr (Any) {
        if (hit) {
          visitor.leaf(node, begin + lane + 1, entries);
          return true;
        }
      }
    }
  }
  visitor.leaf(node, entries, entries);
  return false;
}

[[gnu::target("avx2"), gnu::always_inline]] inline unsigned lanes_of(__m256d mask) {
  return static_cast<unsigned>(_mm256_movemask_pd(mask)) & 7U;
}

[[gnu::target("avx2"), gnu::always_inline]] inline __m256d lane_mask(unsigned bits) {
  return _mm256_castsi256_pd(
      _mm256_load_si256(reinterpret_cast<const __m256i*>(lane_masks.lanes[bits].data())));
}

/// walk_octree for doubles and triangles without holes: what asks about hits would slow the loop down.
template <bool Any, class Visitor>
[[gnu::target("avx2")]] bool walk_octree_avx2(const OctreeView& view, const WalkStart<double>& start,
                                              const RaySetup<double>& setup, Best<double>& best,
                                              Visitor& visitor) {
  // Without a visitor nobody needs the visits to empty leaves.
  constexpr bool skip_empty = std::is_same_v<Visitor, NullVisitor>;
  const VectorRay ray{_mm256_set1_pd(setup.origin_x), _mm256_set1_pd(setup.origin_y),
                      _mm256_set1_pd(setup.origin_z), _mm256_set1_pd(setup.shear_x),
                      _mm256_set1_pd(setup.shear_y)};
  const __m256d half = _mm256_set1_pd(0.5);
  const std::uint32_t mask = start.mask;
  std::array<VectorSpan, walk_stack_size> stack;
  VectorSpan* top = stack.data();
  __m256d s0 = _mm256_setr_pd(start.root.s0[0], start.root.s0[1], start.root.s0[2], 0.0);
  __m256d s1 = _mm256_setr_pd(start.root.s1[0], start.root.s1[1], start.root.s1[2], 0.0);
  double in = start.root.in;
  double out = start.root.out;
  std::uint32_t node = 0;
  for (;;) {
    const OctreeNode record = view.packed[node];
    if (record.leaf()) {
      if (test_packs<Any>(view, record, node, setup, ray, best, visitor)) {
        return true;
      }
    } else {
      visitor.branch(node);
      const __m256d m = _mm256_mul_pd(_mm256_add_pd(s0, s1), half);
      const unsigned side = lanes_of(_mm256_cmp_pd(m, _mm256_set1_pd(in), _CMP_LE_OQ));
      const unsigned before_out = lanes_of(_mm256_cmp_pd(m, _mm256_set1_pd(out), _CMP_LT_OQ));
      const unsigned crossed = before_out & ~side;
      const unsigned filled = skip_empty ? record.info : 0xffU;
      if (crossed != 0) {
        // (mx, my, mx) <= (my, mz, mz)
        const unsigned outcome = lanes_of(_mm256_cmp_pd(_mm256_permute4x64_pd(m, 0b11000100),
                                                        _mm256_permute4x64_pd(m, 0b11101001), _CMP_LE_OQ));
        alignas(32) std::array<double, 4> planes;
        _mm256_store_pd(planes.data(), m);
        // Push the later children, the last one first.
        const unsigned order = crossing_order[outcome][crossed];
        unsigned child = side | crossed;
        for (int shift = 2 * std::popcount(crossed) - 2; shift >= 0; shift -= 2) {
          const unsigned axis = (order >> static_cast<unsigned>(shift)) & 3U;
          const double since = planes[axis];
          const unsigned physical = child ^ mask;
          if (((filled >> physical) & 1U) != 0) {
            const __m256d upper = lane_mask(child);
            top->s0 = _mm256_blendv_pd(s0, m, upper);
            top->s1 = _mm256_blendv_pd(m, s1, upper);
            top->in = since;
            top->out = out;
            top->node = record.first + physical;
            ++top;
          }
          out = since;
          child ^= 1U << axis;
        }
      }
      const unsigned physical = side ^ mask;
      if (((filled >> physical) & 1U) != 0) {
        const __m256d upper = lane_mask(side);
        s0 = _mm256_blendv_pd(s0, m, upper);
        s1 = _mm256_blendv_pd(m, s1, upper);
        node = record.first + physical;
        continue;
      }
    }
    if (top == stack.data()) {
      return false;
    }
    --top;
    in = top->in;
    if (in > best.t + start.slack) {
      return false;
    }
    s0 = top->s0;
    s1 = top->s1;
    out = top->out;
    node = top->node;
  }
}

}  // namespace marti::accel

#endif
