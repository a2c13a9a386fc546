// Internal to scenes/: the Gaussians of a PLY file, as trainers of 3D Gaussian splatting write them.
#pragma once

#include <cstdint>

#include "scenes/gaussians.h"
#include "scenes/ply_header.h"
#include "scenes/ply_values.h"
#include "scenes/source_file.h"

namespace marti::scenes {

/// Whether the entries are Gaussians: they have scales and rotations, or colours as harmonics.
[[nodiscard]] bool holds_gaussians(const PlyElement& vertex);

/// Reads the properties x, y, z; f_dc_0 to f_dc_2 and f_rest_0 to f_rest_8, _23 or _44, or none of these:
/// harmonics of each colour; opacity, as the logit; scale_0 to scale_2, as natural logarithms; rot_0 to
/// rot_3, a quaternion (w, x, y, z) of any length but 0. Others are passed over. Counts in `unseen` those
/// that are left out because no ray sees them. Throws UserError with the line or the byte, and the number of
/// the vertex.
[[nodiscard]] Gaussians read_gaussians(const PlyElement& vertex, PlyValues& values, const SourceFile& file,
                                       std::uint64_t& unseen);

}  // namespace marti::scenes
