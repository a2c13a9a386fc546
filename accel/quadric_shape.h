// A sphere, cylinder or cone laid out for intersection.
#pragma once

#include <array>
#include <cstdint>

#include "scenes/quadric.h"

namespace marti::accel {

/// The kinds that the kernels distinguish. A cylinder is a cone with constant radius and has the same kernel.
enum class PrimitiveKind : std::uint8_t { triangle, sphere, cone };

/// The numbers that the kernel, the overlap test and shading read. For a cone the radius at height h above
/// the centre is radius + slope * h, for -half <= h <= half. These numbers define the primitive: computing
/// them rounds, which moves it a little, but all later computations use exactly the same surface.
struct QuadricShape {
  PrimitiveKind kind = PrimitiveKind::sphere;
  std::array<double, 3> center{};  ///< a sphere's centre, or the middle of a cone's axis
  std::array<double, 3> axis{};    ///< unit vector from the first end to the second; zero for a sphere
  double half = 0.0;               ///< half the height
  double radius = 0.0;             ///< at the centre
  double slope = 0.0;              ///< growth of the radius along the axis
  double cosine = 1.0;         ///< 1 / sqrt(1 + slope^2): from radial distance to distance from the surface
  double reach = 0.0;          ///< upper bound of the distance of its points from the centre
  std::array<double, 3> lo{};  ///< the box around it, rounded outwards
  std::array<double, 3> hi{};
};

/// The quadric must be valid (scenes/quadric.h).
[[nodiscard]] QuadricShape shape_of(const scenes::Quadric& quadric);

}  // namespace marti::accel
