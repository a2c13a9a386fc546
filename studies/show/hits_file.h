// What the rays of image.rays hit, as an array of NumPy.
#pragma once

#include <cstdint>
#include <string>

#include "processors/program/render.h"

namespace marti::studies::show {

/// The content of hits.npy, a list with an entry for each of the `rays` rays of a frame rendered with
/// RenderOptions::hits, in their order:
/// - distance (float64), in units of the direction's length; infinite without a hit;
/// - primitive (int64): triangles from 0, in the order of the scene, then spheres, cylinders and cones; -1
///   without a hit;
/// - weights (three float64), barycentric, of the triangle's corners; 0 for other primitives.
/// Of a ray that any hit will do for and that has one, the distance is not a number and the primitive -2.
[[nodiscard]] std::string hits_file(const processors::program::Frame& frame, std::uint64_t rays);

}  // namespace marti::studies::show
