// Internal to scenes/: where a part of a scene stands in the whole.
#pragma once

#include <string>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "scenes/scene.h"

namespace marti::scenes {

/// An affine map: a point p goes to linear * p + offset. `linear` is not singular (is_singular).
struct Placement {
  glm::dmat3 linear{1.0};
  glm::dvec3 offset{0.0};
};

/// Whether a volume would become flat: the columns' determinant is at most 1e-10 of their lengths' product.
[[nodiscard]] bool is_singular(const glm::dmat3& linear);

/// The factor by which all lengths grow; 0 if there is no such factor.
[[nodiscard]] double common_scale(const glm::dmat3& linear);

/// Turned about the x axis, then about y, then about z, in degrees. Whole quarter turns are exact.
[[nodiscard]] glm::dmat3 rotation_by(const glm::dvec3& degrees);

/// Moves all of the scene: its vertices and normals, curved primitives, lights, and its camera unless it is
/// one that frames the scene. A mirroring placement reverses triangles, so that their outer sides stay
/// outside. Lights keep their strength, and their range grows as lengths do in the mean. Throws UserError,
/// beginning with `name`, when a coordinate becomes larger than 1e30, when curved primitives are not scaled
/// alike in all directions, and when the camera has no view any more.
void place(const Placement& placement, const std::string& name, Scene& scene);

}  // namespace marti::scenes
