// Scenes of random Gaussians.
#pragma once

#include <cstdint>
#include <memory>
#include <random>

#include "program_scenes.h"
#include "scenes/gaussian_proxies.h"

namespace marti::processors::test {

/// `count` Gaussians about the origin, seen from outside: long ones, flat ones, some that are as thin as a
/// film, and some that are in the same place as another.
inline scenes::Scene random_gaussians(std::uint64_t seed, unsigned count, unsigned degree,
                                      scenes::Instances instances) {
  std::mt19937_64 random(seed);
  const auto draw = [&random](double from, double to) {
    return from + (to - from) * static_cast<double>(random() >> 11U) * 0x1p-53;
  };
  scenes::Gaussians all;
  all.degree = degree;
  while (all.shapes.size() < count) {
    scenes::Splat splat;
    splat.center = {draw(-1, 1), draw(-1, 1), draw(-1, 1)};
    splat.deviation = {draw(0.005, 0.3), draw(0.005, 0.2), draw(0.002, 0.1)};
    splat.rotation = {draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1)};
    splat.opacity = draw(0.0, 1.0);
    splat.deviation.z *= random() % 8 == 0 ? 1e-5 : 1.0;
    if (const auto gaussian = scenes::gaussian_of(splat)) {
      all.add(random() % 8 == 0 && !all.shapes.empty() ? all.shapes.back() : *gaussian);
      for (unsigned i = 0; i < 3 * all.terms(); ++i) {
        all.coefficients.push_back(static_cast<float>(draw(-0.6, 0.9)));
      }
    }
  }
  scenes::Scene scene = looking_down(4.0);
  scene.background = {0.2, 0.3, 0.5};
  scene.gaussians = std::make_shared<const scenes::Gaussians>(std::move(all));
  scenes::stand_proxies(scene, instances, 1'000'000);
  return scene;
}

}  // namespace marti::processors::test
