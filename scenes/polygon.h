// Cuts simple polygons into triangles without new vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace marti::scenes {

/// The sign of the area of (a, b, c): 1 counter-clockwise, -1 clockwise, 0 collinear. Exact, barring
/// overflow and underflow of products (J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and
/// Fast Robust Geometric Predicates, 1997: a filter, then an expansion).
[[nodiscard]] int orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);

/// Triangulates a simple polygon, given counter-clockwise, by cutting ears (G. H. Meisters, Polygons Have
/// Ears, 1975), each time the ear with the shortest diagonal, the first among equals. Returns n - 2 triangles
/// of indices into `corners`, counter-clockwise too; collinear corners may give some without area. Throws
/// UserError for fewer than 3 corners or when no ear is left, as in a polygon that intersects itself.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::dvec2> corners);

}  // namespace marti::scenes
