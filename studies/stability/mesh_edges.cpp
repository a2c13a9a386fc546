#include "studies/stability/mesh_edges.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

namespace marti::studies::stability {

namespace {

// The narrowest that something may look if rays that are off by eight roundings are to meet it.
double narrowest(double rounding, const glm::dvec3& origin, const glm::dvec3& target) {
  return 0x1p8 * rounding * (largest(origin) + largest(target));
}

// The ray at `target`, where t is 1, with limits around the surface that it must meet there. A ray that is
// off by eight roundings meets it up to 2^-5 of `reach`, the length of its longest side, away from the
// target, because it looks at least 256 roundings wide.
accel::Ray limited_around(const glm::dvec3& origin, const glm::dvec3& target, double reach) {
  accel::Ray ray{origin, target - origin};
  const double margin = 0x1p-4 * reach / glm::length(ray.direction) + 0x1p-10;
  ray.t_min = std::max(0.0, 1.0 - margin);
  ray.t_max = 1.0 + margin;
  return ray;
}

// The distance of `point` from the plane through `origin`, `a` and `b`, and on which side it is.
double height_over(const glm::dvec3& origin, const glm::dvec3& a, const glm::dvec3& b,
                   const glm::dvec3& point) {
  const glm::dvec3 normal = glm::cross(a - origin, b - origin);
  return glm::dot(normal, point - origin) / glm::length(normal);
}

}  // namespace

MeshEdges::MeshEdges(const accel::TriangleSet& triangles) : triangles_(triangles) {
  const auto at = [&](std::uint32_t corner) {
    const glm::dvec3 p = triangles_.corner(corner / 3, corner % 3) + 0.0;  // no -0.0
    return std::tuple(p.x, p.y, p.z);
  };
  std::vector<std::uint32_t> order(std::size_t{3} * triangles.triangles());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
  ids_.resize(order.size());
  std::uint32_t last = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    last += k > 0 && at(order[k]) != at(order[k - 1]) ? 1U : 0U;
    ids_[order[k]] = last;
  }
  for (std::uint32_t triangle = 0; triangle < triangles.triangles(); ++triangle) {
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t a = id(triangle, k);
      const std::uint32_t b = id(triangle, (k + 1) % 3);
      if (a != b) {
        sides_.push_back({{std::min(a, b), std::max(a, b)}, triangle});
      }
    }
  }
  std::ranges::sort(sides_);
  for (std::size_t k = 0; k < sides_.size(); ++all_) {
    const std::size_t first = k;
    for (; k < sides_.size() && sides_[k].first == sides_[first].first; ++k) {
    }
    open_ += k - first == 1 ? 1U : 0U;
  }
}

std::optional<std::uint32_t> MeshEdges::neighbour(std::uint32_t triangle, unsigned first) const {
  const auto [low, high] = std::minmax({id(triangle, first), id(triangle, (first + 1) % 3)});
  const std::array ends = {low, high};
  const auto begin = std::ranges::lower_bound(sides_, ends, {}, &Side::first);
  const auto end = std::ranges::upper_bound(sides_, ends, {}, &Side::first);
  if (end - begin != 2 || begin[0].second == begin[1].second) {
    return std::nullopt;
  }
  return begin[0].second == triangle ? begin[1].second : begin[0].second;
}

unsigned MeshEdges::third(std::uint32_t triangle, unsigned first, std::uint32_t other) const {
  unsigned k = 0;
  while (k < 2 && (id(other, k) == id(triangle, first) || id(other, k) == id(triangle, (first + 1) % 3))) {
    ++k;
  }
  return k;
}

std::optional<accel::Ray> MeshEdges::at_edge(std::uint32_t triangle, unsigned first, double rounding,
                                             const glm::dvec3& origin, double along) const {
  const std::optional<std::uint32_t> other = neighbour(triangle, first);
  if (!other) {
    return std::nullopt;
  }
  const glm::dvec3 a = triangles_.corner(triangle, first);
  const glm::dvec3 b = triangles_.corner(triangle, (first + 1) % 3);
  const glm::dvec3 target = a + along * (b - a);
  const double least = narrowest(rounding, origin, target);
  // The third corners are seen on either side of the edge, and no other side is near the target.
  double product = 1.0;
  double reach = glm::length(b - a);
  for (const glm::dvec3& c : {triangles_.corner(triangle, (first + 2) % 3),
                              triangles_.corner(*other, third(triangle, first, *other))}) {
    const double height = height_over(origin, a, b, c);
    const bool wide = std::abs(height) >= least && std::abs(height_over(origin, a, c, target)) >= least &&
                      std::abs(height_over(origin, b, c, target)) >= least;
    product *= wide ? height : 0.0;
    reach = std::max({reach, glm::length(c - a), glm::length(c - b)});
  }
  return product < 0.0 ? std::optional(limited_around(origin, target, reach)) : std::nullopt;
}

std::vector<accel::Ray> MeshEdges::rays_at_edges(std::uint32_t count, double rounding,
                                                 std::uint64_t seed) const {
  std::vector<accel::Ray> rays;
  if (triangles_.triangles() == 0) {
    return rays;
  }
  Random random(seed);
  const scenes::Bounds& box = triangles_.bounds();
  const glm::dvec3 middle = 0.5 * (box.lo + box.hi);
  const double size = glm::length(box.hi - box.lo);
  for (std::uint64_t trial = 0; rays.size() < count && trial < std::uint64_t{20} * count; ++trial) {
    const std::uint32_t triangle = random.below(triangles_.triangles());
    const unsigned first = random.below(3);
    const glm::dvec3 outside = middle + size * random.direction();
    const glm::dvec3 inside = random.in_box(box.lo, box.hi);
    const std::optional<accel::Ray> ray =
        at_edge(triangle, first, rounding, trial % 2 == 0 ? outside : inside, random.unit());
    if (ray) {
      rays.push_back(*ray);
    }
  }
  return rays;
}

}  // namespace marti::studies::stability
