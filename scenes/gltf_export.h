// Writes a scene as binary glTF 2.0.
//
// Spheres, cylinders and cones, which glTF does not have, become triangles (tessellate.h says how fine).
// Positions and normals become 32-bit floats; triangles keep their order (unless that would take more than
// 4,096 primitives: then they are sorted by material). What glTF cannot hold, or only rounded, stands in
// `extras.marti`, which open_gltf reads back, so that the scene is the same in every bit:
//   of a primitive, where rounding changes a value, { "POSITION": v, "NORMAL": v, "TEXCOORD_0": v }: buffer
//     views of the same values as little-endian 64-bit floats, packed;
//   of a material, which is written approximately as metallic/roughness, transmission and index of refraction
//     for other programs, { "color": [r,g,b], "specular_color": [r,g,b], "emission": [r,g,b], "diffuse": x,
//     "reflection": x, "transmission": x, "ior": x, "highlight": x, "shininess": x };
//   of a camera, { "at": [x,y,z], "up": [x,y,z] };
//   of a light, { "color": [r,g,b], "direction": [x,y,z], "cos_inner_cone": x, "cos_outer_cone": x,
//     "inverse_square": false when its intensity does not fall off };
//   of the file, { "background": [r,g,b], "ambient": [r,g,b], "lights_are_all": true when the
//     lights of the file are all that the scene has, so that a file without lights stays dark }.
// Values other than a material's and the file's count only where they still agree with the file's own. Notes
// and polygon numbers are not kept.
#pragma once

#include <filesystem>

#include "scenes/scene.h"
#include "scenes/texture.h"

namespace marti::scenes {

/// Writes `source` to `path`, first under a temporary name beside it, which is then renamed, so that a
/// failure leaves no partial file. Throws UserError when the scene has no primitive or has Gaussians, when it
/// has textures and `encode` is empty, when it does not fit the format (4 GiB), or when the file cannot be
/// written.
void export_glb(const Scene& source, const std::filesystem::path& path, const ImageEncoder& encode = {});

}  // namespace marti::scenes
