// Cuts spheres, cylinders and cones into triangles, for programs and formats without curved primitives.
#pragma once

#include <cstdint>

#include "scenes/scene.h"

namespace marti::scenes {

/// Sides of the polygons that circles become. Their corners lie on the circle, so no point of a facet is
/// farther from the surface than 1 - cos(pi / 24) = 0.9 % of the radius (for a cone 0.9 % of its larger
/// radius); on a sphere, where facets deviate in both directions, 1.8 %.
inline constexpr std::uint32_t tessellation_sides = 24;

/// Adds the quadrics of `scene` as triangles after its own, with the surfaces' normals at their corners, and
/// clears the quadrics. A sphere becomes 528 triangles, a cylinder or truncated cone 48, a full cone 24. Each
/// quadric counts as one more polygon, and a note says how many there were. Throws UserError for an invalid
/// quadric and when the vertices would not fit 32-bit indices.
void tessellate(Scene& scene);

}  // namespace marti::scenes
