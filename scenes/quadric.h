// Curved primitives: spheres, and open cylinders and cones, as in the Standard Procedural Databases.
#pragma once

#include <cstdint>
#include <string>

#include <glm/vec3.hpp>

namespace marti::scenes {

/// Cylinders and cones are lateral surfaces without end caps, two-sided like triangles. A cone may be
/// truncated, or end in a point.
enum class QuadricKind : std::uint8_t { sphere, cylinder, cone };

/// One curved primitive. In a scene of T triangles the primitive id of Scene::quadrics[i] is T + i. It has no
/// texture coordinates, so a material's texture does not show on it.
///
/// A quadric is valid (check_quadric) if it has
///  - numbers of magnitude up to 2^300;
/// - a radius (for a cone, the larger one) from 2^-300 to 2^300, and no negative radius;
///  - two ends that lie apart: by at least 2^-20 of the larger radius (a flatter cone is a disc) and at most
///    2^40 radii (a thinner cylinder is a line).
struct Quadric {
  QuadricKind kind = QuadricKind::sphere;
  glm::dvec3 base{0.0};        ///< a sphere's centre; the middle of a cylinder's or cone's first end
  glm::dvec3 tip{0.0};         ///< the middle of the second end; not used by spheres
  double radius = 1.0;         ///< of a sphere or cylinder; a cone's at `base`
  double tip_radius = 0.0;     ///< a cone's at `tip`; not used by the others
  std::uint32_t material = 0;  ///< index into Scene::materials
  std::uint32_t source = 0;    ///< number of the curved primitive in the source, from 0

  /// The radius at `tip`, for any kind.
  [[nodiscard]] double end_radius() const { return kind == QuadricKind::cone ? tip_radius : radius; }
};

/// Throws UserError, beginning with `name`, when the quadric is not valid.
void check_quadric(const Quadric& quadric, const std::string& name);

}  // namespace marti::scenes
