// The box that every subdividing structure divides, and its margins.
#pragma once

#include <cstdint>
#include <string_view>

#include <glm/vec3.hpp>

#include "accel/triangles.h"
#include "scenes/scene.h"

namespace marti::accel {

/// The root box and the values that follow from it.
struct RootFrame {
  /// The tight box of the triangles enlarged by 192 delta, and at least D / 4096 thick on every axis (it
  /// grows upwards, so that a flat scene does not lie in a mid-plane). Empty without triangles.
  scenes::Bounds box;
  double delta = 0.0;  ///< by how much cells are enlarged when triangles are sorted into them; see octree.h
  double far = 0.0;    ///< an origin farther than this from `center` on some axis takes the slow walk
  glm::dvec3 center{0.0};
  double largest_inverse = 0.0;  ///< cap on 1 / |direction component|, so that no plane's parameter overflows
};

/// `enclose`, unless empty, is a box that the root box must contain: that of all frames of an animation, so
/// that every frame has the same root. It is ignored without triangles. Throws UserError when one of its
/// coordinates is not a number of magnitude up to 2^300, or when lo > hi on some axis.
[[nodiscard]] RootFrame make_frame(const TriangleSet& triangles, const scenes::Bounds& enclose = {});

/// How many diagonals of the box an origin may be away on an axis before it is far, unless asked otherwise.
inline constexpr double usual_reach = 64.0;
/// The frame of primitives with this tight box. Larger `reach`es, powers of two up to 2^14, make delta larger
/// in proportion, so that it covers the rounding of parameters of rays from farther away.
[[nodiscard]] RootFrame make_frame(const scenes::Bounds& tight, double reach);

/// Throws UserError, naming the structure and its option, when the value is out of range.
void require_range(std::string_view structure, std::string_view option, std::uint64_t value, std::uint64_t lo,
                   std::uint64_t hi);

}  // namespace marti::accel
