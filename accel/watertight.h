// The ray/triangle intersection of the whole project, watertight and two-sided.
//
// Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Per ray the space is
// translated to the origin and sheared so that the ray becomes the z axis; a triangle is hit when the
// origin of the plane lies inside its projection. A sheared vertex depends on the vertex and the ray only, so
// two triangles on an edge see the same operands. An edge function is the difference of two rounded
// products; rounding is monotone, so when the products differ its sign is exact, and when they are equal it
// is zero, which counts as inside for both triangles. Hence no ray passes between them. All of it rests on
// products not being contracted into fused multiply-adds (-ffp-contract=off).
//
// Accuracy. When the projection is a sliver (|det| below 2^-8 of the sum of the magnitudes of the six
// products) the rounding of the products would show in the barycentrics; the edge functions are then
// computed again by Kahan's difference of products, whose error is at most 1.5 ulp (Jeannerod, Louvet,
// Muller, "Further analysis of Kahan's algorithm", Math. Comp. 82, 2013). Either way the point of the ray at
// t lies within 2^-42 of the triangle's size plus 8 * 2^-53 of its distance of the triangle. The structures'
// margins (octree.h) are sized for that. With floats it is 2^-13 of the size and 2^-21 of the distance and of
// the coordinates, which are rounded to floats first.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "accel/counted.h"
#include "accel/cut_outs.h"
#include "accel/nearest_gaussians.h"
#include "accel/ray.h"
#include "accel/real.h"
#include "accel/triangles.h"

namespace marti::accel {

/// Throws InternalError when a ray's origin or direction is not finite, or the largest component of its
/// direction is below the scalar's smallest normal number or beyond its largest.
[[noreturn]] void reject_ray();

/// Constants of one ray: kz is the axis of the largest direction component, kx and ky the next ones in
/// cyclic order; shear is d[k] / d[kz], and scale 1 / d[kz].
template <class Real>
struct RaySetup {
  unsigned kx;
  unsigned ky;
  unsigned kz;
  Real origin_x;
  Real origin_y;
  Real origin_z;
  Real shear_x;
  Real shear_y;
  Real scale;
  Real t_min;
  Real t_max;

  explicit RaySetup(const Ray& ray);
};

/// Edge functions of the three corners of one triangle; the corner's barycentric weight is its share of
/// their sum.
template <class Real>
struct EdgeFunctions {
  Real u;
  Real v;
  Real w;
};

template <class Real>
struct Best;

/// Says whether a hit of a triangle counts, and tells a visitor that wants to know. Where Gaussians are asked
/// for none does: front faces of their proxies are offered to a buffer.
class HitFilter {
 public:
  HitFilter() = default;
  /// `visitor`: that of the walk.
  template <class Visitor>
  HitFilter(const TriangleSet& triangles, Visitor& visitor) : cut_outs_(triangles.cut_outs()) {
    if constexpr (std::is_base_of_v<AnyHitListener, Visitor>) {
      listener_ = &visitor;
    }
  }
  template <class Visitor>
  HitFilter(NearestGaussians& nearest, Visitor& visitor) : nearest_(&nearest) {
    if constexpr (std::is_base_of_v<AnyHitListener, Visitor>) {
      listener_ = &visitor;
    }
  }
  /// Whether it may have to be asked at all.
  [[nodiscard]] bool on() const { return cut_outs_ != nullptr || nearest_ != nullptr; }
  [[nodiscard]] bool wants_gaussians() const { return nearest_ != nullptr; }
  [[nodiscard]] bool passes(std::uint32_t triangle, const std::array<double, 3>& weights) const;
  /// The hit of a front face of the proxy with this primitive. May shorten the ray.
  template <class Real>
  void offer(std::uint32_t primitive, Best<Real>& best) const;

 private:
  /// Returns the limit that follows from `limit`.
  [[nodiscard]] double offer(std::uint32_t gaussian, double limit) const;

  const CutOuts* cut_outs_ = nullptr;
  NearestGaussians* nearest_ = nullptr;
  AnyHitListener* listener_ = nullptr;
};

/// The best hit so far: least t, then lowest primitive id. `t` begins at t_max, so one comparison tests both
/// limits.
template <class Real>
struct Best {
  Real t;
  std::uint32_t primitive = no_primitive;
  EdgeFunctions<Real> edges{Real(0.0), Real(0.0), Real(0.0)};
  Real det{1.0};
  HitFilter filter;
  /// Added to the ids of primitives that are tested: those of an instance are its own. Modulo 2^32.
  std::uint32_t first = 0;

  /// `which`: what decides whether a hit of a triangle with holes counts; without it each does.
  explicit Best(const RaySetup<Real>& setup, const HitFilter& which = {})
      : t(plain(setup.t_max) < RealFormat<Real>::largest ? setup.t_max : Real(RealFormat<Real>::largest)),
        filter(which) {}
  [[nodiscard]] bool found() const { return primitive != no_primitive; }
  /// The hit with its barycentrics.
  [[nodiscard]] Hit hit() const {
    if (!found()) {
      return {};
    }
    return {plain(t), primitive, plain(edges.u / det), plain(edges.v / det), plain(edges.w / det)};
  }
};

template <class Real>
void HitFilter::offer(std::uint32_t primitive, Best<Real>& best) const {
  const auto limit = static_cast<double>(plain(best.t));
  const double shorter = offer(primitive / scenes::proxy_triangles, limit);
  if (shorter < limit) {
    best.t = Real(shorter);
    best.primitive = nearest_->last();  // walks look whether it has changed
  }
}

/// A sheared corner.
template <class Real>
struct Sheared {
  Real x;
  Real y;
};

/// Edge functions by error-free difference of products, for slivers.
template <class Real>
[[nodiscard]] EdgeFunctions<Real> accurate_edges(const Sheared<Real>& a, const Sheared<Real>& b,
                                                 const Sheared<Real>& c);
extern template EdgeFunctions<float> accurate_edges(const Sheared<float>&, const Sheared<float>&,
                                                    const Sheared<float>&);
extern template EdgeFunctions<double> accurate_edges(const Sheared<double>&, const Sheared<double>&,
                                                     const Sheared<double>&);
extern template EdgeFunctions<Counted> accurate_edges(const Sheared<Counted>&, const Sheared<Counted>&,
                                                      const Sheared<Counted>&);

/// With |det| below this share of the products' magnitudes, the accurate computation is used.
inline constexpr double sliver_share = 0x1p-8;

template <class Real>
RaySetup<Real>::RaySetup(const Ray& ray) {
  using std::abs;
  const std::array<Real, 3> d{Real(ray.direction.x), Real(ray.direction.y), Real(ray.direction.z)};
  const std::array<Real, 3> o{Real(ray.origin.x), Real(ray.origin.y), Real(ray.origin.z)};
  const std::array<Real, 3> size{abs(d[0]), abs(d[1]), abs(d[2])};
  kz = size[0] < size[1] ? (size[1] < size[2] ? 2U : 1U) : (size[0] < size[2] ? 2U : 0U);
  kx = kz == 2U ? 0U : kz + 1U;
  ky = kx == 2U ? 0U : kx + 1U;
  // A NaN or an infinity among the six numbers makes this a NaN. As a mere check it is not counted.
  const double finite = 0.0 * ray.direction.x + 0.0 * ray.direction.y + 0.0 * ray.direction.z +
                        0.0 * ray.origin.x + 0.0 * ray.origin.y + 0.0 * ray.origin.z;
  if (!(plain(size[kz]) + finite >= RealFormat<Real>::least && plain(size[kz]) <= RealFormat<Real>::largest))
      [[unlikely]] {
    reject_ray();
  }
  origin_x = o[kx];
  origin_y = o[ky];
  origin_z = o[kz];
  scale = Real(1.0) / d[kz];
  shear_x = d[kx] / d[kz];
  shear_y = d[ky] / d[kz];
  if (abs(shear_x) < Real(least_shear<Real>)) {
    shear_x = Real(0.0);
  }
  if (abs(shear_y) < Real(least_shear<Real>)) {
    shear_y = Real(0.0);
  }
  t_min = Real(ray.t_min);
  t_max = Real(ray.t_max);
}

/// The corners' weights as Best::hit() has them, uncounted.
template <class Real>
[[nodiscard]] std::array<double, 3> weights_of(const EdgeFunctions<Real>& edges, Real det) {
  using Format = std::conditional_t<std::is_same_v<Real, float>, float, double>;
  const auto share = [&](Real edge) {
    return static_cast<double>(static_cast<Format>(plain(edge)) / static_cast<Format>(plain(det)));
  };
  return {share(edges.u), share(edges.v), share(edges.w)};
}

/// The part after the sign test, for a triangle whose edge functions agree in sign: parameter, limits, order.
/// The depths are the corners' coordinates along kz, relative to the origin. True when the triangle became
/// the best. Without `Holes`, best.filter is off.
template <bool Holes = true, class Real>
inline bool accept(const RaySetup<Real>& ray, const EdgeFunctions<Real>& edges, Real det, Real depth_a,
                   Real depth_b, Real depth_c, std::uint32_t id, Best<Real>& best) {
  using std::max;
  using std::min;
  const Real a = ray.scale * depth_a;
  const Real b = ray.scale * depth_b;
  const Real c = ray.scale * depth_c;
  Real t = (edges.u * a + edges.v * b + edges.w * c) / det;
  t = max(t, min(min(a, b), c));
  t = min(t, max(max(a, b), c));
  if (!(t >= ray.t_min) || !(t <= best.t) || (t == best.t && best.first + id >= best.primitive)) {
    return false;
  }
  if constexpr (Holes) {
    if (best.filter.on()) [[unlikely]] {
      if (best.filter.wants_gaussians()) {
        // The edges' sign is that of the winding as seen along the positive axis kz.
        if ((plain(det) > 0.0) == (plain(ray.scale) > 0.0)) {
          best.filter.offer(best.first + id, best);
        }
        return false;
      }
      if (!best.filter.passes(id, weights_of(edges, det))) {
        return false;
      }
    }
  }
  best.t = t;
  best.primitive = best.first + id;
  best.edges = edges;
  best.det = det;
  return true;
}

/// True when both signs occur; zeros count as either.
template <class Real>
[[nodiscard]] inline bool outside(const EdgeFunctions<Real>& e) {
  const Real zero(0.0);
  return (e.u < zero || e.v < zero || e.w < zero) && (e.u > zero || e.v > zero || e.w > zero);
}

/// Tests one triangle. True when it became the best hit; `best` then holds it.
template <class Real>
inline bool intersect(const RaySetup<Real>& ray, const TriangleCorners& corners, std::uint32_t id,
                      Best<Real>& best) {
  using std::abs;
  const Real az = Real(corners[ray.kz]) - ray.origin_z;
  const Real bz = Real(corners[3 + ray.kz]) - ray.origin_z;
  const Real cz = Real(corners[6 + ray.kz]) - ray.origin_z;
  const Sheared<Real> a{(Real(corners[ray.kx]) - ray.origin_x) - ray.shear_x * az,
                        (Real(corners[ray.ky]) - ray.origin_y) - ray.shear_y * az};
  const Sheared<Real> b{(Real(corners[3 + ray.kx]) - ray.origin_x) - ray.shear_x * bz,
                        (Real(corners[3 + ray.ky]) - ray.origin_y) - ray.shear_y * bz};
  const Sheared<Real> c{(Real(corners[6 + ray.kx]) - ray.origin_x) - ray.shear_x * cz,
                        (Real(corners[6 + ray.ky]) - ray.origin_y) - ray.shear_y * cz};
  const Real cx_by = c.x * b.y;
  const Real cy_bx = c.y * b.x;
  const Real ax_cy = a.x * c.y;
  const Real ay_cx = a.y * c.x;
  const Real bx_ay = b.x * a.y;
  const Real by_ax = b.y * a.x;
  EdgeFunctions<Real> edges{cx_by - cy_bx, ax_cy - ay_cx, bx_ay - by_ax};
  if (outside(edges)) {
    return false;
  }
  Real det = edges.u + edges.v + edges.w;
  const Real products = (abs(cx_by) + abs(cy_bx)) + (abs(ax_cy) + abs(ay_cx)) + (abs(bx_ay) + abs(by_ax));
  // The condition is also true for NaN, which then fails every comparison below.
  if (!(abs(det) >= Real(sliver_share) * products)) [[unlikely]] {
    edges = accurate_edges(a, b, c);
    if (outside(edges)) {
      return false;
    }
    det = edges.u + edges.v + edges.w;
  }
  if (det == Real(0.0)) {
    return false;
  }
  return accept(ray, edges, det, az, bz, cz, id, best);
}

}  // namespace marti::accel
