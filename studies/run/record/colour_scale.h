// The scale of colours that maps are drawn in.
#pragma once

#include <glm/vec3.hpp>

namespace marti::studies::run {

/// Viridis (S. van der Walt, N. Smith, for matplotlib, 2015; public domain), from eleven of its colours:
/// equal steps of `share` look equally large, lightness rises from dark blue to yellow, and every kind of
/// colour blindness sees the same order. `share` is clamped to 0..1. The result is linear RGB.
[[nodiscard]] glm::vec3 colour_of(double share);

}  // namespace marti::studies::run
