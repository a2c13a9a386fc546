// The k nearest Gaussians of a ray, in order: what a ray asks in the place of its closest hit, as in 3D
// Gaussian ray tracing (Moenne-Loccoz et al., TOG 43(6), 2024, section 4.2: a buffer that an any-hit program
// fills).
//
// The rule. A ray meets a Gaussian where it comes within the ellipsoid of alpha 1/255, and in front of it
// lies the entry of its proxy: the distance at which the ray enters the ten slabs of the icosahedron.
// Gaussians follow one another by entry, and by number where two are equal. One whose proxy the ray begins in
// is not met, as its front face lies behind, nor one that begins within least_entry(). Entry and least
// distance are computed from ray and Gaussian alone, in the scene's coordinates, so the answer depends
// neither on the structure, nor on the order of tests, nor on whether proxies are kept or copied, nor on k. A
// proxy that is asked about twice, because the ray meets an edge or two cells list it, gives the same answer
// twice.
//
// Why none is missed. The proxies' triangles only find candidates: the front face by which the ray enters is
// tested unless it lies outside the ray's interval, and there the kernel reports the entry but for rounding.
// A ray that meets a Gaussian goes through that face at an angle whose sine, in the ellipsoid's coordinates,
// is above (proxy_inradius - 1) / 2.3 > 2^-8: from a point 1 + 2^-6 above the centre's plane, and less
// than 1.3 from the centre, it comes within 1 of it. A point that is off by e, in the scene, is off by e
// times the stretch of the Gaussian along the ray at most when both are brought there, and so the entry by
// 2^8 e stretch. The kernel and transforms that turn and then scale along axes (stretch_of() is 3 at most,
// instance.h), and the slabs here, are off by less than 2^-46 of the distance, or of the triangle's size. So
// intervals are wider than the entries they stand for by 2^-38 of distance and scene, times the largest
// stretch, and at least by 2^-30. Only a Gaussian that is thinner than 2^-40 of its distance could be missed
// where it is seen edge on.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "accel/ray.h"
#include "scenes/gaussians.h"

namespace marti::accel {

/// A Gaussian that a ray meets.
struct GaussianHit {
  double entry = 0.0;  ///< of its proxy, in units of the ray's direction
  std::uint32_t gaussian = 0;
  double squared = 0.0;  ///< the ray's least squared distance from the centre, 1 where alpha is 1/255

  [[nodiscard]] bool before(const GaussianHit& other) const {
    return entry < other.entry || (entry == other.entry && gaussian < other.gaussian);
  }
};

/// The least squared distance of the ray from the centre of a Gaussian, in coordinates in which its alpha is
/// 1/255 at a distance of 1. Real: the scalar of the arithmetic.
template <class Real>
[[nodiscard]] inline Real least_squared(const scenes::Gaussian& gaussian, const Ray& ray) {
  std::array<Real, 3> o;
  std::array<Real, 3> d;
  const std::array<Real, 3> from = {Real(ray.origin.x) - Real(gaussian.center.x),
                                    Real(ray.origin.y) - Real(gaussian.center.y),
                                    Real(ray.origin.z) - Real(gaussian.center.z)};
  for (std::size_t row = 0; row < 3; ++row) {
    const auto r = static_cast<glm::length_t>(row);
    const std::array<Real, 3> m = {Real(gaussian.inverse[0][r]), Real(gaussian.inverse[1][r]),
                                   Real(gaussian.inverse[2][r])};
    o[row] = m[0] * from[0] + m[1] * from[1] + m[2] * from[2];
    d[row] = m[0] * Real(ray.direction.x) + m[1] * Real(ray.direction.y) + m[2] * Real(ray.direction.z);
  }
  const std::array<Real, 3> across = {o[1] * d[2] - o[2] * d[1], o[2] * d[0] - o[0] * d[2],
                                      o[0] * d[1] - o[1] * d[0]};
  const Real length = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  return (across[0] * across[0] + across[1] * across[1] + across[2] * across[2]) / length;
}

/// Where the ray enters the Gaussian's proxy, if it goes through it; else any number.
[[nodiscard]] double proxy_entry(const scenes::Gaussian& gaussian, const Ray& ray);

/// The buffer of one ray at a time. A query of a structure fills it (Queries::nearest), round after round.
class NearestGaussians {
 public:
  /// `most`: k, at least 1. `reach`: the scene's size. Keeps a reference.
  NearestGaussians(const scenes::Gaussians& all, std::uint32_t most, double reach)
      : all_(all), most_(most), share_(std::max(0x1p-30, 0x1p-38 * all.stretch)), slack_(share_ * reach) {}

  /// A new ray, whose direction must be of unit length and whose t_max infinite.
  void begin(const Ray& ray);
  /// Begins a round: for the Gaussians behind those of the round before. Returns where the ray of the round
  /// begins, its t_min.
  [[nodiscard]] double next_round();
  /// Puts the Gaussian into the buffer if it is among the k nearest so far. Returns `limit`, or if it is less
  /// the distance beyond which no front face matters any more.
  double offer(std::uint32_t gaussian, double limit);

  /// Gaussians that a ray enters before this are not met.
  [[nodiscard]] double least_entry() const { return slack_; }
  /// The first of the Gaussian's records in a database.
  [[nodiscard]] std::uint32_t record(std::uint32_t gaussian) const { return gaussian * all_.records(); }
  /// Those of the round, the nearest first.
  [[nodiscard]] std::span<const GaussianHit> hits() const { return hits_; }
  /// Whether there may be more behind them.
  [[nodiscard]] bool full() const { return hits_.size() == most_; }
  /// The number of the last of them: changes whenever what offer() returns does.
  [[nodiscard]] std::uint32_t last() const { return hits_.back().gaussian; }

 private:
  const scenes::Gaussians& all_;
  std::uint32_t most_;
  double share_;  // by how much intervals are wider: of the distance
  double slack_;  // and in all
  Ray ray_;
  GaussianHit after_;
  bool first_ = true;
  std::vector<GaussianHit> hits_;
};

}  // namespace marti::accel
