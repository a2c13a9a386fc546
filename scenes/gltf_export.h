// Writes a scene as binary glTF 2.0.
//
// Spheres, cylinders and cones, which glTF does not have, become triangles (tessellate.h says how fine).
// Positions and normals become 32-bit floats; triangles keep their order (unless that would take more than
// 4,096 primitives: then they are sorted by material). Materials are written twice: approximately as
// metallic/roughness, transmission and index of refraction for other programs, and exactly in `extras.marti`,
// which open_gltf reads back:
//   { "color": [r,g,b], "specular_color": [r,g,b], "emission": [r,g,b], "diffuse": x, "reflection": x,
//     "transmission": x, "ior": x, "highlight": x, "shininess": x }
// A light's `extras.marti` holds { "inverse_square": false } when its intensity does not fall off; the
// file's holds { "background": [r,g,b], "ambient": [r,g,b] }. Notes and polygon numbers are not kept.
#pragma once

#include <filesystem>

#include "scenes/scene.h"
#include "scenes/texture.h"

namespace marti::scenes {

/// Writes `source` to `path`, first under a temporary name beside it, which is then renamed, so that a
/// failure leaves no partial file. Throws UserError when the scene has no primitive, when it has textures and
/// `encode` is empty, when it does not fit the format (4 GiB), or when the file cannot be written.
void export_glb(const Scene& source, const std::filesystem::path& path, const ImageEncoder& encode = {});

}  // namespace marti::scenes
