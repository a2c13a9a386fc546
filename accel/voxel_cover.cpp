#include "accel/voxel_cover.h"

#include <utility>

namespace marti::accel {

namespace {

// Keeps the part of the polygon where sign * (p[axis] - plane) >= 0.
void clip_to_half_space(std::vector<glm::dvec3>& points, int axis, double plane, double sign) {
  thread_local std::vector<glm::dvec3> kept;
  kept.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3& from = points[i];
    const glm::dvec3& to = points[(i + 1) % points.size()];
    const double before = sign * (from[axis] - plane);
    const double after = sign * (to[axis] - plane);
    if (before >= 0.0) {
      kept.push_back(from);
    }
    if ((before < 0.0 && after > 0.0) || (before > 0.0 && after < 0.0)) {
      glm::dvec3 cut = from + (to - from) * (before / (before - after));
      cut[axis] = plane;
      kept.push_back(cut);
    }
  }
  std::swap(points, kept);
}

}  // namespace

void clip_to_box(const TriangleCorners& triangle, const glm::dvec3& lo, const glm::dvec3& hi,
                 std::vector<glm::dvec3>& points) {
  points.clear();
  for (std::size_t corner = 0; corner < 9; corner += 3) {
    points.emplace_back(triangle[corner], triangle[corner + 1], triangle[corner + 2]);
  }
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    clip_to_half_space(points, axis, lo[axis], 1.0);
    clip_to_half_space(points, axis, hi[axis], -1.0);
  }
}

}  // namespace marti::accel
