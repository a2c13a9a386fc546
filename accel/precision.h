// Whether floats suffice for a scene, or it needs doubles, in which all of marti's arithmetic is done.
//
// A float has 24 bits, spent from the largest coordinate downwards: a scene far from the origin has few of
// them left for its own shape, and products of very large or very small lengths leave a float's range.
// watertight.h computes in floats too (closest<float> of every structure), so that this can be seen.
#pragma once

#include <cstdint>
#include <string>

#include "accel/triangles.h"

namespace marti::accel {

/// The effect of rounding a scene's coordinates to floats.
struct PrecisionNeed {
  std::uint64_t primitives = 0;
  /// Number of primitives that have an area (curved ones: an extent on every axis), but not after their
  /// corners (bounds) are rounded to floats.
  std::uint64_t collapsed = 0;
  /// Number of primitives whose longest edge (extent) is beyond 2^62 or, unless it is 0, below 2^-62:
  /// products of two such values leave a float's range.
  std::uint64_t out_of_range = 0;
  double largest = 0.0;  ///< the largest magnitude of a coordinate
  double spacing = 0.0;  ///< distance of floats at the largest coordinate
  double steps = 0.0;    ///< such distances along the scene's longest axis; 0 when the scene is a point

  /// Whether floats would visibly change an image: a primitive is lost, or one is moved by more than 1/65536
  /// of the scene (fewer steps than that).
  [[nodiscard]] bool wants_double() const;
};

/// Takes time proportional to the number of primitives.
[[nodiscard]] PrecisionNeed precision_need(const TriangleSet& set);

/// One sentence for users who consider floats; empty when floats would suffice.
[[nodiscard]] std::string describe_need(const PrecisionNeed& need);

}  // namespace marti::accel
