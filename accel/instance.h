// Instances: meshes that stand in several places of a scene without being copied. A ray is brought into the
// mesh's own coordinates and tested there, so its parameter t is that of the scene.
//
// Rounding. With x = M y + s from the mesh to the scene, a ray's origin o goes to M^-1 (o - c) + y_c, where c
// is the centre of the instance's box and y_c that of the mesh's: so its error grows with the distance from
// the instance and not with that from the scene's origin. Seen from the scene it is at most k 2^-50 of that
// distance, where k is the largest row sum of |M| |M^-1|, and the direction's error moves points as little
// again. The kernel's own error is 2^-50 of the distance (watertight.h), so an instance is as exact as a copy
// but for the factor k, which is 1 for scales along the axes and at most 3 for rotations.
#pragma once

#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "accel/ray.h"
#include "accel/real.h"
#include "scenes/instance.h"
#include "scenes/scene.h"

namespace marti::accel {

/// An instance as walks use it. Immutable.
class Instance {
 public:
  /// `mesh_box`: the tight box of the mesh; `first`: what is added to the ids of the mesh's primitives.
  /// Throws UserError for a transform that scenes::why_not_kept names, or one that moves the mesh beyond
  /// 2^300.
  Instance(const scenes::InstancePlace& place, const scenes::Bounds& mesh_box, std::uint32_t first);

  [[nodiscard]] std::uint32_t mesh() const { return mesh_; }
  [[nodiscard]] std::uint32_t first() const { return first_; }
  /// k, above.
  [[nodiscard]] double stretch() const { return stretch_; }
  /// The box of the mesh's box in the scene.
  [[nodiscard]] const scenes::Bounds& box() const { return box_; }

  /// The ray in the mesh's coordinates, with the parameters of the scene. Real: the scalar of the arithmetic.
  template <class Real>
  [[nodiscard]] Ray in_mesh(const Ray& ray) const {
    Ray local = ray;
    const auto turn = [this](const Real(&v)[3], int row) {
      return Real(inverse_[0][row]) * v[0] + Real(inverse_[1][row]) * v[1] + Real(inverse_[2][row]) * v[2];
    };
    const Real direction[3] = {Real(ray.direction.x), Real(ray.direction.y), Real(ray.direction.z)};
    const Real origin[3] = {Real(ray.origin.x) - Real(center_.x), Real(ray.origin.y) - Real(center_.y),
                            Real(ray.origin.z) - Real(center_.z)};
    for (int row = 0; row < 3; ++row) {
      local.direction[row] = static_cast<double>(plain(turn(direction, row)));
      local.origin[row] = static_cast<double>(plain(turn(origin, row) + Real(mesh_center_[row])));
    }
    return local;
  }

 private:
  std::uint32_t mesh_ = 0;
  std::uint32_t first_ = 0;
  glm::dmat3 inverse_{1.0};
  glm::dvec3 center_{0.0};
  glm::dvec3 mesh_center_{0.0};
  double stretch_ = 1.0;
  scenes::Bounds box_;
};

}  // namespace marti::accel
