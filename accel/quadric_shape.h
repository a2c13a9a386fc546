// A sphere, cylinder or cone laid out for intersection.
#pragma once

#include <array>
#include <cstdint>

#include "scenes/quadric.h"

namespace marti::accel {

/// What the kernels tell apart. A cylinder is a cone whose radius does not change: the same kernel.
enum class PrimitiveKind : std::uint8_t { triangle, sphere, cone };

/// The numbers the kernel, the overlap test and shading read. For a cone the radius at height h above the
/// centre is radius + slope * h, for -half <= h <= half. The numbers themselves are the primitive: rounding
/// in making them moves it a little, but everything after sees one and the same surface.
struct QuadricShape {
  PrimitiveKind kind = PrimitiveKind::sphere;
  std::array<double, 3> center{};  ///< a sphere's centre, or the middle of a cone's axis
  std::array<double, 3> axis{};    ///< unit vector from the first end to the second; zero for a sphere
  double half = 0.0;               ///< half the height
  double radius = 0.0;             ///< at the centre
  double slope = 0.0;              ///< growth of the radius along the axis
  double cosine = 1.0;         ///< 1 / sqrt(1 + slope^2): from radial distance to distance from the surface
  double reach = 0.0;          ///< no point is farther from the centre; rounded up
  std::array<double, 3> lo{};  ///< the box around it, rounded outwards
  std::array<double, 3> hi{};
};

/// The quadric must be valid (scenes/quadric.h).
[[nodiscard]] QuadricShape shape_of(const scenes::Quadric& quadric);

}  // namespace marti::accel
