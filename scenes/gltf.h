// Reading glTF 2.0 scenes (.gltf and .glb), Khronos specification 2.0.1, at rest or in motion.
//
// Read: the chosen scene's nodes with their transforms; indexed and unindexed triangles, strips and fans;
// sparse accessors; positions, normals, the base colour texture's coordinates; morph targets of positions and
// normals (section 3.7.2.2); skins with any number of joints a vertex (3.7.3); animations of nodes and morph
// weights (3.11, Appendix C); materials; perspective cameras; KHR_lights_punctual,
// KHR_materials_transmission, KHR_materials_ior, KHR_materials_emissive_strength, KHR_mesh_quantization,
// KHR_texture_transform, EXT_texture_webp; where marti is built with their libraries
// KHR_draco_mesh_compression and EXT_meshopt_compression (also under its name KHR_meshopt_compression), of
// the whole file. Replaced and counted: what docs/scenes.md lists, unless FileOptions::strict. Left out with
// a note: points and lines, displacements of texture coordinates, other textures, blending. One source
// triangle is one polygon. Indices below 0 count as "not given" where glTF allows that.
//
// Motion. The static pose (nodes, morph weights and joints as in the file, no animation) decides which
// triangles there are: one with a corner that is not finite or beyond 1e30 there is left out of all poses. A
// node that is mirrored by its transform reverses the winding of its triangles; the transform of a skinned
// mesh's node is ignored, including its mirroring. A vertex's joint weights are divided by their sum. If the
// file has no camera, or a light is added to its own, that is made for the pose at time 0 and does not move.
//
// Materials. With base colour c, metallic m, roughness r, transmission t, index of refraction n,
// F0 = ((n-1)/(n+1))^2 and gloss g = (1-r)^2, our weights are
//   diffuse      = (1-m)(1-t)(1-g F0) + m (1-g)   rough metal scatters widely: diffuse of its own colour
//   reflection   = g (m + (1-m) F0)
//   transmission = (1-m) t (1-g F0)               (the three add up to 1)
//   highlight    = m + (1-m) F0
//   shininess    = 2/r^4 - 2, kept in 1 to 100,000  (Blinn-Phong for GGX of alpha = r^2: Walter et al.,
//                  Microfacet Models for Refraction, EGSR 2007, section 5.2)
//   specular colour = white mixed with c by m;  emission = emissive factor times its strength.
// Where alphaMode is MASK, what is cut out has an alpha (the base colour's, factor times texel) below
// alphaCutoff; where it is BLEND, below 0.5. A primitive that no texel can keep is left out.
// A material with valid `extras.marti` (see gltf_export.h) gets the exact weights written there.
//
// Lights keep colour times intensity (candela, lux) unchanged: there is no exposure. Point and spot lights
// fall off with the square of the distance. A camera's aspect ratio is that of the image.
#pragma once

#include <filesystem>

#include "scenes/animated.h"
#include "scenes/file_options.h"
#include "scenes/scene.h"
#include "scenes/texture.h"

namespace marti::scenes {

/// Opens a file. A scene without a camera gets one that frames it, one without lights what
/// FileOptions::default_light says, with a note each. Triangles with a position that is not finite are left
/// out, and a note counts them; degenerate ones are kept and counted. `decode` may be empty; then a material
/// with a base colour texture is refused. Throws UserError, the path first, for anything missing, broken, out
/// of range or not supported, unless it is replaced; no input makes it crash or loop. Of
/// several animations only the chosen one is checked; facts() checks all.
[[nodiscard]] AnimatedScene open_gltf(const std::filesystem::path& path, const FileOptions& options,
                                      const ImageDecoder& decode);

}  // namespace marti::scenes
