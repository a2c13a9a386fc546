#include "accel/nearest_gaussians.h"

#include <algorithm>
#include <limits>

#include <glm/geometric.hpp>

namespace marti::accel {

double proxy_entry(const scenes::Gaussian& gaussian, const Ray& ray) {
  constexpr double root_of_three = 1.7320508075688772;
  const glm::dvec3 origin = gaussian.inverse * (ray.origin - gaussian.center);
  const glm::dvec3 direction = gaussian.inverse * ray.direction;
  double entry = -std::numeric_limits<double>::infinity();
  for (const glm::dvec3& normal : scenes::proxy_normals) {
    const double along = glm::dot(normal, direction);
    const double from = glm::dot(normal, origin);
    if (along != 0.0) {
      entry = std::max(entry, -(from + std::copysign(root_of_three * scenes::proxy_inradius, along)) / along);
    }
  }
  return entry;
}

void NearestGaussians::begin(const Ray& ray) {
  ray_ = ray;
  first_ = true;
  hits_.clear();
}

double NearestGaussians::next_round() {
  if (!hits_.empty()) {
    first_ = false;
    after_ = hits_.back();
    hits_.clear();
  }
  return first_ ? 0.0 : std::max(0.0, after_.entry * (1.0 - share_) - slack_);
}

double NearestGaussians::offer(std::uint32_t gaussian, double limit) {
  const scenes::Gaussian& shape = all_.shapes[gaussian];
  GaussianHit hit{0.0, gaussian, least_squared<double>(shape, ray_)};
  if (!(hit.squared <= 1.0)) {
    return limit;
  }
  hit.entry = proxy_entry(shape, ray_);
  const bool is_full = full();
  if (!(hit.entry >= slack_) || (!first_ && !after_.before(hit)) || (is_full && !hit.before(hits_.back()))) {
    return limit;
  }
  const auto before = [](const GaussianHit& a, const GaussianHit& b) { return a.before(b); };
  const auto at = std::lower_bound(hits_.begin(), hits_.end(), hit, before);
  if (at != hits_.end() && at->gaussian == gaussian) {
    return limit;
  }
  if (is_full) {
    // `at` is not behind the last one, which makes room.
    std::move_backward(at, hits_.end() - 1, hits_.end());
    *at = hit;
  } else {
    hits_.insert(at, hit);
  }
  return full() ? std::min(limit, hits_.back().entry * (1.0 + share_) + slack_) : limit;
}

}  // namespace marti::accel
