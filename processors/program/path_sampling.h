// What Integrator::path draws at random: the numbers, directions into which a surface scatters, and points on
// emissive triangles.
//
// All numbers depend only on pixel, sample, surface point, use and seed, so that a ray that is left out
// shifts no number of another (Salmon et al., "Parallel Random Numbers: As Easy as 1, 2, 3", SC 2011).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "accel/counted.h"
#include "accel/cut_outs.h"
#include "processors/program/sample_points.h"
#include "processors/program/shading.h"
#include "processors/program/vector.h"
#include "scenes/scene.h"
#include "sim/mix.h"

namespace marti::processors::program {

/// What a random number at a surface point decides.
enum class Draw : std::uint32_t {
  lobe,          ///< whether the path goes on as scattered, reflected or refracted light
  roulette,      ///< whether it goes on at all
  emitter,       ///< which emissive triangle
  on_emitter_a,  ///< the point on it
  on_emitter_b,
  direction  ///< the direction of scattered light: this and all that follow, in pairs
};
// With sends_any_hit_rays(), the place of a surface point in the path is that of a ray among those of one
// hit.

/// The random numbers of one sample of a pixel: a stream of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014), of
/// which each surface point of the path has 64.
class PathNumbers {
 public:
  static constexpr std::uint32_t a_point = 64;

  constexpr PathNumbers(std::uint32_t x, std::uint32_t y, std::uint32_t sample, std::uint64_t seed)
      : start_(counted_bits(x, y, sample, 2, seed)) {}

  /// A number of [0, 1) with 53 bits. `bounce`: surface points before this one. `further`: added to `draw`.
  [[nodiscard]] constexpr double at(std::uint32_t bounce, Draw draw, std::uint32_t further = 0) const {
    const std::uint64_t place = std::uint64_t{bounce} * a_point + static_cast<std::uint32_t>(draw) + further;
    return unit_number(sim::mix(start_ + place * sim::mix_step));
  }

 private:
  std::uint64_t start_;
};

/// The number as a scalar of the templates. A counting scalar counts the operations on integers that made it:
/// its place in the stream (a product and two sums), SplitMix64 (a sum, two products, three shifts, three
/// exclusive ors), and the shift before the conversion. Rounded to a float it stays below 1.
template <typename Real>
Real drawn(double number) {
  if constexpr (std::is_same_v<Real, accel::Counted>) {
    accel::operation_counts().integer += 13;
  }
  if constexpr (std::is_same_v<Real, float>) {
    return std::min(static_cast<float>(number), 0x1.fffffep-1F);
  } else {
    return static_cast<Real>(number);
  }
}

/// A point of the unit sphere, found as by Marsaglia, "Choosing a point from the surface of a sphere", Annals
/// of Mathematical Statistics 43(2), 1972: without sines, whose last bits differ between computers.
template <typename Real>
std::optional<Vec3<Real>> on_sphere(const PathNumbers& numbers, std::uint32_t bounce) {
  using std::sqrt;
  // Each try misses the unit circle with probability 0.215; all miss it once in 10^19 points.
  constexpr std::uint32_t most = PathNumbers::a_point - static_cast<std::uint32_t>(Draw::direction) - 1;
  for (std::uint32_t next = 0; next < most; next += 2) {
    const Real a = Real(2.0) * drawn<Real>(numbers.at(bounce, Draw::direction, next)) - Real(1.0);
    const Real b = Real(2.0) * drawn<Real>(numbers.at(bounce, Draw::direction, next + 1)) - Real(1.0);
    const Real squared = a * a + b * b;
    if (!(squared < Real(1.0))) {
      continue;
    }
    const Real side = Real(2.0) * sqrt(Real(1.0) - squared);
    return Vec3<Real>(a * side, b * side, Real(1.0) - Real(2.0) * squared);
  }
  return std::nullopt;
}

/// A direction about the unit normal with a density proportional to its cosine: the normal and a point of the
/// unit sphere, added.
template <typename Real>
Vec3<Real> scattered(const Vec3<Real>& normal, const PathNumbers& numbers, std::uint32_t bounce) {
  const std::optional<Vec3<Real>> point = on_sphere<Real>(numbers, bounce);
  if (!point) {
    return normal;
  }
  const Vec3<Real> sum = normal + *point;
  // Nearly opposite to the normal the sum has no direction.
  return dot(sum, sum) > Real(0x1p-40) ? normalized(sum) : normal;
}

/// Lights without an extent are balls for Integrator::shadow, which are seen under the angle, from the middle
/// to the rim, whose sine this is: 0.9 degrees. Those of the sun are 0.27.
inline constexpr double jitter_of_lights = 0x1p-6;

/// Puts a point on the surface of its ball in the place of a light without an extent. `position`: the light's
/// place, moved along; of no meaning for a directional light.
template <typename Real>
void jitter(const Surface<Real>& surface, const PathNumbers& numbers, std::uint32_t ray,
            LightSample<Real>& light, Vec3<Real>& position) {
  using std::sqrt;
  const std::optional<Vec3<Real>> point = on_sphere<Real>(numbers, ray);
  if (!point) {
    return;
  }
  if (!light.at_infinity) {
    const Vec3<Real> way = position - surface.point;
    position = position + *point * (sqrt(dot(way, way)) * Real(jitter_of_lights));
  }
  light.direction = normalized(light.direction + *point * Real(jitter_of_lights));
}

/// The triangles whose material emits light, for next-event estimation: one of them is drawn in proportion to
/// its area times the sum of the three colours it emits. Spheres, cylinders and cones that emit are not among
/// them.
class Emitters {
 public:
  Emitters() = default;
  explicit Emitters(const scenes::Scene& scene);

  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  /// Whether points of primitive `id` can be drawn.
  [[nodiscard]] bool has(std::uint32_t id) const { return id < is_emitter_.size() && is_emitter_[id]; }

  struct Choice {
    std::uint32_t triangle = 0;
    double area_over_chance = 0.0;  ///< the triangle's area over the probability of choosing it
  };
  /// `number`: in [0, 1). There must be emitters.
  [[nodiscard]] Choice choose(double number) const;
  /// Comparisons that a choice takes at most.
  [[nodiscard]] std::uint32_t comparisons() const { return comparisons_; }

 private:
  std::vector<std::uint32_t> triangles_;
  std::vector<double> weight_up_to_;  ///< sums of the weights, the triangle's own included
  std::vector<double> area_;
  std::vector<bool> is_emitter_;  ///< by primitive
  std::uint32_t comparisons_ = 0;
};

/// The weights of a triangle's corners at a point drawn uniformly from it (Turk, "Generating random points in
/// triangles", Graphics Gems, 1990). a, b: in [0, 1).
template <typename Real>
std::array<Real, 3> point_of_triangle(const Real& a, const Real& b) {
  using std::sqrt;
  const Real root = sqrt(a);
  const Real second = b * root;
  return {Real(1.0) - root, second, root - second};
}

/// A point of an emissive triangle as a light of one surface point. `radiance` is that of a light at this
/// place alone which adds, in the mean over all points that could be drawn, what all emissive triangles add
/// to scattered light: emission, times the cosine at the triangle, over pi, the squared distance and the
/// density with which points are drawn from areas.
template <typename Real>
struct EmitterSample {
  LightSample<Real> light;
  Vec3<Real> target;  ///< where a ray to it ends: just before the triangle
};

/// Draws the point. There must be emitters. One in a hole, which `cut_outs` knows of (null: none), does not
/// shine. `reach`: as for surface_at().
template <typename Real>
EmitterSample<Real> emitter_at(const scenes::Scene& scene, const accel::CutOuts* cut_outs,
                               const Emitters& emitters, const Surface<Real>& surface,
                               const PathNumbers& numbers, std::uint32_t bounce, double reach) {
  using std::sqrt;
  constexpr double one_over_pi = 0.31830988618379067154;
  const Emitters::Choice choice =
      emitters.choose(static_cast<double>(drawn<Real>(numbers.at(bounce, Draw::emitter))));
  if constexpr (std::is_same_v<Real, accel::Counted>) {
    // The choice is made in doubles, which do not count: the number times the sum of weights, a comparison a
    // step of the search, and the difference, quotient and product that make area over chance.
    accel::OperationCounts& counts = accel::operation_counts();
    counts.compare += emitters.comparisons();
    counts.multiply += 2;
    counts.add += 1;
    counts.divide += 1;
  }
  const std::array<Real, 3> b = point_of_triangle(drawn<Real>(numbers.at(bounce, Draw::on_emitter_a)),
                                                  drawn<Real>(numbers.at(bounce, Draw::on_emitter_b)));
  if (cut_outs != nullptr && cut_outs->asks(choice.triangle) &&
      !cut_outs
           ->ask(choice.triangle,
                 {static_cast<double>(b[0]), static_cast<double>(b[1]), static_cast<double>(b[2])})
           .counts) {
    return {};
  }
  const scenes::Triangle& triangle = scene.triangles[choice.triangle];
  const Vec3<Real> corners[3] = {Vec3<Real>(scene.positions[triangle.vertex[0]]),
                                 Vec3<Real>(scene.positions[triangle.vertex[1]]),
                                 Vec3<Real>(scene.positions[triangle.vertex[2]])};
  const Vec3<Real> point = corners[0] * b[0] + corners[1] * b[1] + corners[2] * b[2];
  const Vec3<Real> way = point - surface.point;
  const Real squared = dot(way, way);
  EmitterSample<Real> sample;
  if (!lights_at(squared)) {
    return sample;
  }
  sample.light.direction = way * (Real(1.0) / sqrt(squared));
  const Real weights[3] = {b[0], b[1], b[2]};
  const Surface<Real> there = surface_at(scene, choice.triangle, weights, sample.light.direction, reach);
  const Real cosine = -dot(there.geometric, sample.light.direction);
  sample.light.turn = turn_towards(surface, point, there.error, squared);
  if (!is_more_than_rounding(static_cast<Held<Real>>(cosine), there.tilt_squared, sample.light.turn)) {
    return sample;  // seen edge on
  }
  sample.light.radiance = Vec3<Real>(scene.materials[triangle.material].emission) *
                          (cosine * Real(choice.area_over_chance * one_over_pi) / squared);
  sample.light.reaches = largest(sample.light.radiance) > Real(0.0);
  sample.target = leave(there, -sample.light.direction);
  return sample;
}

}  // namespace marti::processors::program
