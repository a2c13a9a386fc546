// The triangles of a scene laid out for intersection: nine doubles each, nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/scene.h"

namespace marti::accel {

/// Corners a, b, c as ax ay az bx by bz cx cy cz. A vertex shared by triangles is copied bit for bit, which
/// is what makes their common edges watertight.
using TriangleCorners = std::array<double, 9>;

/// Primitive ids are the indices: triangle i is Scene::triangles[i].
class TriangleSet {
 public:
  TriangleSet() = default;
  /// The scene must be valid (see scene.h): finite positions, indices in range.
  explicit TriangleSet(const scenes::Scene& scene);
  /// Finite coordinates of magnitude up to 2^300; throws UserError otherwise.
  explicit TriangleSet(std::vector<TriangleCorners> triangles);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] const TriangleCorners& operator[](std::uint32_t id) const { return triangles_[id]; }
  [[nodiscard]] glm::dvec3 corner(std::uint32_t id, unsigned which) const {
    const double* p = &triangles_[id][std::size_t{3} * which];
    return {p[0], p[1], p[2]};
  }
  /// The tight box of all corners; empty when there is no triangle.
  [[nodiscard]] const scenes::Bounds& bounds() const { return bounds_; }

 private:
  void check();

  std::vector<TriangleCorners> triangles_;
  scenes::Bounds bounds_;
};

}  // namespace marti::accel
