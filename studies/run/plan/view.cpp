#include "studies/run/plan/view.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace marti::studies::run {

namespace {

// Relative to the distance and the coordinates. The kernels find hits up to some 2^-41 of these beside a
// primitive (accel/octree.h).
constexpr double margin = 0x1p-36;
// Least gap between the outermost rays and the sides, relative to the distance; below it rounding matters.
constexpr double thinnest = 0x1p-32;

}  // namespace

View::View(const scenes::ImagePlane& plane, std::uint32_t width, std::uint32_t height, bool several_samples)
    : eye_(plane.origin) {
  const auto at = [&](double x, double y) { return plane.corner + plane.step_x * x + plane.step_y * y; };
  const double w = width;
  const double h = height;
  // The sides lie half a pixel outside the outermost rays, so that rounding cannot make a ray cross them.
  const double ray = several_samples ? 0.0 : 0.5;
  const double edge = ray - 0.5;
  const auto corners = [&](double in) {
    return std::array<glm::dvec3, 4>{at(in, in), at(w - in, in), at(w - in, h - in), at(in, h - in)};
  };
  const std::array<glm::dvec3, 4> edges = corners(edge);
  const std::array<glm::dvec3, 4> outermost = corners(ray);
  const glm::dvec3 middle = at(0.5 * w, 0.5 * h);
  usable_ = true;
  for (std::size_t i = 0; i < outward_.size(); ++i) {
    const glm::dvec3 across = i < edges.size() ? glm::cross(edges[i], edges[(i + 1) % edges.size()]) : middle;
    outward_[i] = across * ((glm::dot(across, middle) > 0.0 ? -1.0 : 1.0) / glm::length(across));
    // All rays lie between the outermost four, so these alone tell on which side all are.
    for (const glm::dvec3& outer : outermost) {
      usable_ = usable_ && -glm::dot(outward_[i], outer) > thinnest * glm::length(outer);
    }
  }
}

template <class Corners>
bool View::may_meet(const Corners& corners) const {
  double reach = 0.0;
  for (const glm::dvec3& corner : corners) {
    reach = std::max(reach, glm::length(corner - eye_) + glm::length(corner));
  }
  return std::ranges::none_of(outward_, [&](const glm::dvec3& outward) {
    return std::ranges::all_of(
        corners, [&](const glm::dvec3& corner) { return glm::dot(outward, corner - eye_) > margin * reach; });
  });
}

bool View::may_meet(const scenes::Scene& scene, std::uint32_t primitive) const {
  if (!usable_) {
    return true;
  }
  if (primitive < scene.triangles.size()) {
    const scenes::Triangle& triangle = scene.triangles[primitive];
    return may_meet(std::array<glm::dvec3, 3>{scene.positions[triangle.vertex[0]],
                                              scene.positions[triangle.vertex[1]],
                                              scene.positions[triangle.vertex[2]]});
  }
  const scenes::Bounds box = scenes::bounds_of(scene.quadrics[primitive - scene.triangles.size()]);
  std::array<glm::dvec3, 8> corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = {(i & 1U) != 0 ? box.hi.x : box.lo.x, (i & 2U) != 0 ? box.hi.y : box.lo.y,
                  (i & 4U) != 0 ? box.hi.z : box.lo.z};
  }
  return may_meet(corners);
}

}  // namespace marti::studies::run
