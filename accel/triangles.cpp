#include "accel/triangles.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "accel/ray.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

/// Makes the corner of a triangle without area that lies between the two others a copy of one of these. No
/// ray hits two equal corners, because the kernel's products of equal numbers are equal; three corners on a
/// line are no longer on one after the kernel has rounded them. The box stays, up to rounding.
void make_unhittable(TriangleCorners& corners) {
  std::size_t between = 0;
  double longest = -1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double length = std::abs(corners[3 * ((k + 1) % 3) + a] - corners[3 * ((k + 2) % 3) + a]);
      if (length > longest) {
        longest = length;
        between = k;
      }
    }
  }
  std::copy_n(&corners[3 * ((between + 1) % 3)], 3, &corners[3 * between]);
}

}  // namespace

TriangleSet::TriangleSet(const scenes::Scene& scene) {
  triangles_.reserve(scene.triangles.size());
  for (const scenes::Triangle& triangle : scene.triangles) {
    TriangleCorners& corners = triangles_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& p = scene.positions[triangle.vertex[k]];
      corners[3 * k] = p.x;
      corners[3 * k + 1] = p.y;
      corners[3 * k + 2] = p.z;
    }
  }
  check_triangles();
  add_quadrics(scene.quadrics);
  if (!scene.instances.empty()) {
    sim::ensure(scene.quadrics.empty(), "a scene with instances and quadrics");
    meshes_ = scene.meshes;
    instances_ = scene.instances;
    bounds_ = scenes::bounds_of(scene);
  }
  gaussians_ = scene.gaussians;
  if (CutOuts holes(scene); !holes.empty()) {
    cut_outs_ = std::make_shared<const CutOuts>(std::move(holes));
  }
}

TriangleSet::TriangleSet(std::vector<TriangleCorners> triangles, const std::vector<scenes::Quadric>& quadrics)
    : triangles_(std::move(triangles)) {
  check_triangles();
  add_quadrics(quadrics);
}

void TriangleSet::check_triangles() {
  if (triangles_.size() >= no_primitive) {
    throw sim::UserError("too many triangles: " + std::to_string(triangles_.size()) + ", at most 4294967294");
  }
  for (std::uint32_t id = 0; id < triangles(); ++id) {
    for (const double x : triangles_[id]) {
      if (!(std::abs(x) <= largest_coordinate)) {
        std::ostringstream message;
        message << "triangle " << id
                << " has a coordinate that is not a number of magnitude up to 2^300: " << x;
        throw sim::UserError(message.str());
      }
    }
    if (scenes::has_no_area(corner(id, 0), corner(id, 1), corner(id, 2))) {
      make_unhittable(triangles_[id]);
    }
    for (unsigned k = 0; k < 3; ++k) {
      bounds_.include(corner(id, k));
    }
  }
}

void TriangleSet::add_quadrics(const std::vector<scenes::Quadric>& quadrics) {
  if (quadrics.size() >= no_primitive - triangles_.size()) {
    throw sim::UserError("too many primitives: " + std::to_string(triangles_.size() + quadrics.size()) +
                         ", at most 4294967294");
  }
  quadrics_.reserve(quadrics.size());
  for (const scenes::Quadric& quadric : quadrics) {
    scenes::check_quadric(quadric, "the sphere, cylinder or cone " + std::to_string(quadrics_.size()));
    const QuadricShape& shape = quadrics_.emplace_back(shape_of(quadric));
    bounds_.include({shape.lo[0], shape.lo[1], shape.lo[2]});
    bounds_.include({shape.hi[0], shape.hi[1], shape.hi[2]});
  }
}

scenes::Bounds TriangleSet::bounds(PrimitiveRange range) const {
  scenes::Bounds box;
  for (std::uint32_t id = range.first; id < range.first + range.count; ++id) {
    if (id < triangles()) {
      for (unsigned k = 0; k < 3; ++k) {
        box.include(corner(id, k));
      }
    } else {
      const QuadricShape& shape = quadric(id);
      box.include({shape.lo[0], shape.lo[1], shape.lo[2]});
      box.include({shape.hi[0], shape.hi[1], shape.hi[2]});
    }
  }
  return box;
}

}  // namespace marti::accel
