// What geometry is checked with: brute force for every structure, closed meshes for every kernel.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "studies/stability/hostile.h"
#include "studies/stability/icosphere.h"
#include "studies/stability/stability_case.h"

namespace marti::studies::stability {

/// Something that traces rays: a structure, a kernel alone, or one that is broken on purpose.
using Tracer = std::function<accel::Hit(const accel::Ray&)>;

/// A structure as a tracer; it must stay.
template <class Structure>
Tracer tracer_of(const Structure& structure) {
  return [&structure](const accel::Ray& ray) {
    accel::NullVisitor visitor;
    return structure.closest(ray, visitor);
  };
}

/// Every kind of structure, in several shapes: as configured by default, as deep as they go, with the other
/// walks, matched, lazy. Brute force is not among them. Few of them with `deep` false: for large scenes.
[[nodiscard]] std::vector<std::unique_ptr<accel::Structure>> build_structures(
    const std::shared_ptr<const accel::TriangleSet>& triangles, bool deep = true);

/// Compares a structure with brute force on the rays of one class: id, t and weights bit for bit, and whether
/// anything is hit at all.
[[nodiscard]] Tally disagreements(const accel::TriangleSet& triangles, const Tracer& oracle,
                                  const std::vector<std::unique_ptr<accel::Structure>>& structures,
                                  const scenes::Bounds& box, Aim aim, std::uint32_t rays, std::uint64_t seed);

/// Like the function above, for all structures over these triangles and rays of all classes in equal parts.
[[nodiscard]] Tally disagreements(std::vector<accel::TriangleCorners> corners, std::uint32_t rays,
                                  std::uint64_t seed, bool deep = true);

/// Equal bit for bit.
[[nodiscard]] bool same_hit(const accel::Hit& a, const accel::Hit& b);

/// A mesh moved and scaled, with the vertices its triangles share.
struct PlacedSphere {
  Icosphere sphere;
  glm::dvec3 center;
  double size;
  std::vector<glm::dvec3> vertices;
  std::vector<accel::TriangleCorners> triangles;

  /// The unit sphere of 20 * 4^times triangles, times `size`, at (offset, -offset, offset / 2).
  PlacedSphere(int times, double offset, double scale);
};

/// Rays from inside at vertices, edges and faces by turns; a ray that hits nothing, by `trace`, is a leak.
[[nodiscard]] Tally leaks(const PlacedSphere& mesh, const Tracer& trace, std::uint32_t rays,
                          std::uint64_t seed);

}  // namespace marti::studies::stability
