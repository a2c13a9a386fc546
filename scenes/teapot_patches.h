// The Utah teapot: 32 bicubic Bezier patches, with the data published by M. Newell (1975), in the numbering
// of the model's common copies.
#pragma once

#include <array>
#include <cstdint>

namespace marti::scenes {

/// Sixteen indices into teapot_points a patch, row by row: parameter s runs over rows, t over columns.
extern const std::array<std::array<std::uint16_t, 16>, 32> teapot_patches;

/// Control points x, y, z; z is up, the table is at 0.
extern const std::array<std::array<double, 3>, 290> teapot_points;

}  // namespace marti::scenes
