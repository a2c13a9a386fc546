// What a ray sees of a Gaussian: its alpha and its colour.
#pragma once

#include <array>

#include "accel/nearest_gaussians.h"
#include "processors/program/power.h"
#include "processors/program/vector.h"
#include "scenes/binary_power.h"
#include "scenes/gaussians.h"
#include "scenes/harmonics.h"

namespace marti::processors::program {

/// The light that a ray has collected from front to back, and the share that shines through what it has met.
template <typename Real>
struct Collected {
  Vec3<Real> color;
  Real through{1.0};
};

/// Adds a Gaussian that the ray meets. Its alpha is at most 0.99, as in 3D Gaussian splatting; its colour is
/// one half and its harmonics in the ray's direction, a unit vector, and not below 0.
template <typename Real>
void collect(const scenes::Gaussians& all, const accel::GaussianHit& hit, const Vec3<Real>& direction,
             Collected<Real>& light) {
  using std::max;
  using std::min;
  const scenes::Gaussian& gaussian = all.shapes[hit.gaussian];
  const Real response = scenes::two_to(-(Real(hit.squared) * Real(gaussian.falloff)));
  const Real alpha = min(Real(0.99), Real(gaussian.opacity) * response);
  std::array<Real, scenes::most_harmonics> harmonics;
  scenes::harmonics_at(direction, all.degree, harmonics);
  const auto channel = [&](unsigned which) {
    Real sum(0.5);
    std::size_t term = 0;
    for (const float coefficient : all.of(hit.gaussian, which)) {
      sum = sum + Real(coefficient) * harmonics[term++];
    }
    return max(sum, Real(0.0));
  };
  light.color = light.color + Vec3<Real>(channel(0), channel(1), channel(2)) * (alpha * light.through);
  light.through = light.through * (Real(1.0) - alpha);
}

/// Trained colours are those of a screen (sRGB, IEC 61966-2-1); images here are linear.
[[nodiscard]] inline double linear_of_screen(double value) {
  if (value <= 0.04045) {
    return value / 12.92;
  }
  return value < 1.0 ? power((value + 0.055) / 1.055, 2.4) : 1.0;
}

}  // namespace marti::processors::program
