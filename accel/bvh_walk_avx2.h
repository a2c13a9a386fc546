// The walk of bvh_walk.h for doubles on machines with AVX2: the boxes of a record in vectors of four or eight
// floats. Each lane does the operations of that walk for one box in their order, so visits and hits are
// equal, bit for bit.
#pragma once

#include "sim/avx2.h"

#ifdef MARTI_AVX2

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "accel/bvh_nodes.h"
#include "accel/bvh_ray.h"
#include "accel/visitor.h"
#include "accel/watertight.h"

namespace marti::accel {

/// Where the ray enters the boxes of a record.
struct alignas(32) BvhEntries {
  std::array<float, 8> in;
};

/// Eight planes; `side` is 0 for those that the ray meets first.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256 planes_of(const BvhNode<8>& node,
                                                                    const BvhRay<float>& ray,
                                                                    std::size_t axis, std::uint32_t side) {
  return _mm256_load_ps(node.plane[ray.near_side[axis] ^ side][axis].data());
}
/// Eight planes from bytes; those beyond the node's width are of no child.
template <BvhInBytes Node>
[[gnu::target("avx2"), gnu::always_inline]] inline __m256 planes_of(const Node& node,
                                                                    const BvhRay<float>& ray,
                                                                    std::size_t axis, std::uint32_t side) {
  const auto* const bytes =
      reinterpret_cast<const __m128i*>(node.plane[ray.near_side[axis] ^ side][axis].data());
  return _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(bytes)));
}
/// Four planes, or two in half a vector.
[[gnu::target("avx2"), gnu::always_inline]] inline __m128 planes_of(const BvhNode<4>& node,
                                                                    const BvhRay<float>& ray,
                                                                    std::size_t axis, std::uint32_t side) {
  return _mm_load_ps(node.plane[ray.near_side[axis] ^ side][axis].data());
}
[[gnu::target("avx2"), gnu::always_inline]] inline __m128 planes_of(const BvhNode<2>& node,
                                                                    const BvhRay<float>& ray,
                                                                    std::size_t axis, std::uint32_t side) {
  const auto* const two =
      reinterpret_cast<const __m128i*>(node.plane[ray.near_side[axis] ^ side][axis].data());
  return _mm_castsi128_ps(_mm_loadl_epi64(two));
}

/// The children whose boxes the ray meets before `limit`, as bits; writes where it enters them.
[[gnu::target("avx2"), gnu::always_inline]] inline unsigned met_children(const BvhNode<8>& node,
                                                                         const BvhRay<float>& ray,
                                                                         float limit, BvhEntries& entries) {
  __m256 in = _mm256_setzero_ps();
  __m256 out = _mm256_set1_ps(limit);
  for (std::size_t a = 0; a < 3; ++a) {
    const __m256 reciprocal = _mm256_set1_ps(ray.reciprocal[a]);
    in = _mm256_max_ps(in, _mm256_add_ps(_mm256_mul_ps(planes_of(node, ray, a, 0), reciprocal),
                                         _mm256_set1_ps(ray.near[a])));
    out = _mm256_min_ps(out, _mm256_add_ps(_mm256_mul_ps(planes_of(node, ray, a, 1), reciprocal),
                                           _mm256_set1_ps(ray.far[a])));
  }
  _mm256_store_ps(entries.in.data(), in);
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(in, out, _CMP_LE_OQ)));
}

template <std::size_t Width>
[[gnu::target("avx2"), gnu::always_inline]] inline unsigned met_children(const BvhNode<Width>& node,
                                                                         const BvhRay<float>& ray,
                                                                         float limit, BvhEntries& entries) {
  __m128 in = _mm_setzero_ps();
  __m128 out = _mm_set1_ps(limit);
  for (std::size_t a = 0; a < 3; ++a) {
    const __m128 reciprocal = _mm_set1_ps(ray.reciprocal[a]);
    in = _mm_max_ps(in,
                    _mm_add_ps(_mm_mul_ps(planes_of(node, ray, a, 0), reciprocal), _mm_set1_ps(ray.near[a])));
    out = _mm_min_ps(out,
                     _mm_add_ps(_mm_mul_ps(planes_of(node, ray, a, 1), reciprocal), _mm_set1_ps(ray.far[a])));
  }
  _mm_store_ps(entries.in.data(), in);
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(in, out))) & ((1U << Width) - 1U);
}

/// The children that a node has, as bits.
[[gnu::target("avx2"), gnu::always_inline]] inline unsigned all_children(const BvhQuantisedNode& node) {
  const __m128i absent = _mm_cmpeq_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(node.meta.data())),
                                        _mm_setzero_si128());
  return ~static_cast<unsigned>(_mm_movemask_epi8(absent));
}
[[gnu::target("avx2"), gnu::always_inline]] inline unsigned all_children(const BvhSixNode& node) {
  return (1U << node.count) - 1U;
}

template <BvhInBytes Node>
[[gnu::target("avx2"), gnu::always_inline]] inline unsigned met_children(const Node& node,
                                                                         const BvhRay<float>& ray,
                                                                         float limit, BvhEntries& entries) {
  __m256 in = _mm256_setzero_ps();
  __m256 out = _mm256_set1_ps(limit);
  for (std::size_t a = 0; a < 3; ++a) {
    const __m256 step = _mm256_set1_ps(node.step(a) * ray.reciprocal[a]);
    const float corner = node.corner[a] * ray.reciprocal[a];
    in = _mm256_max_ps(in, _mm256_add_ps(_mm256_mul_ps(planes_of(node, ray, a, 0), step),
                                         _mm256_set1_ps(corner + ray.near[a])));
    out = _mm256_min_ps(out, _mm256_add_ps(_mm256_mul_ps(planes_of(node, ray, a, 1), step),
                                           _mm256_set1_ps(corner + ray.far[a])));
  }
  _mm256_store_ps(entries.in.data(), in);
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(in, out, _CMP_LE_OQ))) & all_children(node);
}

/// Begins to fetch what a waiting child's visit reads first.
template <class Node>
[[gnu::always_inline]] inline void fetch(const BvhView<Node>& view, const BvhChild& child) {
  const bool branch = child.entries == 0;
  const auto* const record = branch ? reinterpret_cast<const char*>(view.nodes + child.record)
                                    : reinterpret_cast<const char*>(view.primitives + child.record);
  const std::size_t bytes = branch ? sizeof(Node) : sizeof(BvhPrimitive);
  for (std::size_t byte = 0; byte < bytes; byte += 64) {
    _mm_prefetch(record + byte, _MM_HINT_T0);
  }
}

/// walk_bvh for doubles.
template <bool Any, class View, class Visitor>
[[gnu::target("avx2")]] bool walk_bvh_avx2(const View& view, const BvhRay<float>& ray,
                                           const BvhDistance<double>& distance, const RaySetup<double>& setup,
                                           Best<double>& best, Visitor& visitor) {
  using Node = typename View::Record;
  using Waiting = BvhWaiting<float>;
  std::array<Waiting, bvh_stack_size<Node::width>> stack;
  Waiting* top = stack.data();
  float limit = distance.limit(best.t);
  Waiting now{0.0F, view.root, {}};
  BvhEntries entries;
  for (;;) {
    if (now.child.entries == 0) {
      visitor.branch(now.number);
      const Node& node = view.nodes[now.child.record];
      unsigned met = met_children(node, ray, limit, entries);
      if (met != 0) {
        const std::uint32_t first = view.first_child(now.child.record);
        auto c = static_cast<std::uint32_t>(std::bit_width(met)) - 1U;
        now = {entries.in[c], first + c, node.child(c)};
        const Waiting* const begin = top;
        while ((met ^= 1U << c) != 0) {
          c = static_cast<std::uint32_t>(std::bit_width(met)) - 1U;
          Waiting other{entries.in[c], first + c, node.child(c)};
          if (other.in <= now.in) {
            std::swap(now, other);
          }
          Waiting* at = top++;
          for (; at != begin && at[-1].in < other.in; --at) {
            *at = at[-1];
          }
          *at = other;
          fetch(view, other.child);
        }
        if constexpr (SeesEntered<Visitor>) {
          EnteredChildren entered;
          entered.add(now.number - first);
          for (const Waiting* at = top; at != begin;) {
            entered.add((--at)->number - first);
          }
          visitor.entered(entered);
        }
        continue;
      }
      if constexpr (SeesEntered<Visitor>) {
        visitor.entered({});
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
      if (top == stack.data()) {
        return false;
      }
      now = *--top;
    } while (now.in > limit);
  }
}

}  // namespace marti::accel

#endif
