// Whether a scene can do with floats, or needs doubles as all of marti's own arithmetic has.
//
// A float has 24 bits, spent from the largest coordinate downwards: a scene far from the origin has few of
// them left for its own shape, and products of very large or very small lengths leave a float's range.
// watertight.h computes in floats too (closest<float> of every structure), so that this can be seen.
#pragma once

#include <cstdint>
#include <string>

#include "accel/triangles.h"

namespace marti::accel {

/// What rounding a scene's coordinates to floats would do to it.
struct PrecisionNeed {
  std::uint64_t primitives = 0;
  /// With an area (or, of curved ones, an extent on every axis) as they are, and without when their corners
  /// (bounds) are rounded to floats.
  std::uint64_t collapsed = 0;
  /// Their longest edge (extent) is beyond 2^62 or, unless it is 0, below 2^-62: products of two leave a
  /// float's range.
  std::uint64_t out_of_range = 0;
  double largest = 0.0;  ///< coordinate, its magnitude
  double spacing = 0.0;  ///< of floats at the largest coordinate
  double steps = 0.0;    ///< of that spacing across the scene's longest axis; 0 when the scene is a point

  /// Floats would lose what an image shows: a primitive, or the place of one by more than 1/65536 of the
  /// scene (fewer steps than that).
  [[nodiscard]] bool wants_double() const;
};

/// In time proportional to the number of primitives.
[[nodiscard]] PrecisionNeed precision_need(const TriangleSet& set);

/// One sentence for a person who may have thought of floats; empty when they would do.
[[nodiscard]] std::string describe_need(const PrecisionNeed& need);

}  // namespace marti::accel
