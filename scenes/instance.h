// Instances: meshes that stand in several places of a scene without being copied.
#pragma once

#include <cstdint>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace marti::scenes {

/// Consecutive primitives.
struct PrimitiveRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// A mesh in a place: x = linear y + shift for each point y of the mesh.
struct InstancePlace {
  std::uint32_t mesh = 0;
  glm::dmat3 linear{1.0};
  glm::dvec3 shift{0.0};
  /// The primitive id of the mesh's first triangle here; those of its others follow.
  std::uint32_t first = 0;
  /// Bound of the distance by which rounding, of doubles, may move its surface (Scene::instances).
  double rounding = 0.0;

  [[nodiscard]] glm::dvec3 of(const glm::dvec3& point) const { return linear * point + shift; }
  /// The unit normal of a surface with this normal in the mesh; zero stays zero.
  [[nodiscard]] glm::dvec3 normal_of(const glm::dvec3& normal) const;
  /// Whether it winds triangles the other way round.
  [[nodiscard]] bool mirrors() const;
};

/// The largest row sum of |M| |M^-1|: by how much the rounding of a ray in the mesh's coordinates is larger
/// when seen from the scene. 1 for scales along the axes, at most 3 for rotations.
[[nodiscard]] double stretch_of(const glm::dmat3& linear);

/// Why rays cannot be brought into the coordinates of a mesh in this place: its transform is not finite, is
/// singular, scales by more than 2^60 or its stretch_of is beyond 2^10. Empty when they can.
[[nodiscard]] std::string why_not_kept(const InstancePlace& place);

}  // namespace marti::scenes
