#include "processors/program/path_sampling.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace marti::processors::program {

Emitters::Emitters(const scenes::Scene& scene) {
  std::vector<double> emitted;  // of each material
  for (const scenes::Material& material : scene.materials) {
    emitted.push_back(material.emission.x + material.emission.y + material.emission.z);
  }
  double sum = 0.0;
  for (std::uint32_t id = 0; id < scene.triangles.size(); ++id) {
    const scenes::Triangle& triangle = scene.triangles[id];
    if (!(emitted[triangle.material] > 0.0)) {
      continue;
    }
    const auto corner = [&](std::size_t k) { return Vec3<double>(scene.positions[triangle.vertex.at(k)]); };
    const Vec3<double> twice = cross(corner(1) - corner(0), corner(2) - corner(0));
    const double area = 0.5 * std::sqrt(dot(twice, twice));
    const double weight = area * emitted[triangle.material];
    // One that is too small or too large for its square to be a number is met by chance only.
    if (!(weight > 0.0) || !std::isfinite(sum + weight)) {
      continue;
    }
    sum += weight;
    is_emitter_.resize(scene.triangles.size());
    is_emitter_[id] = true;
    triangles_.push_back(id);
    weight_up_to_.push_back(sum);
    area_.push_back(area);
  }
  comparisons_ = static_cast<std::uint32_t>(std::bit_width(triangles_.size()));
}

Emitters::Choice Emitters::choose(double number) const {
  const double sum = weight_up_to_.back();
  const auto found = std::upper_bound(weight_up_to_.begin(), weight_up_to_.end(), number * sum);
  const auto at = std::min(static_cast<std::size_t>(found - weight_up_to_.begin()), weight_up_to_.size() - 1);
  const double weight = weight_up_to_[at] - (at == 0 ? 0.0 : weight_up_to_[at - 1]);
  return {triangles_[at], area_[at] * (sum / weight)};
}

}  // namespace marti::processors::program
