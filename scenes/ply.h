// Reading PLY files (.ply; G. Turk, The PLY Polygon File Format, Stanford 1994), as text and in binary of
// both orders of bytes.
//
// Read: the element "vertex" with x, y, z and, if it has them, nx, ny, nz, and texture coordinates u, v, or
// s, t, or either after "texture_" (v goes up, and is turned); the element "face" with the list
// vertex_indices or vertex_index, of any integer type, each a polygon (scenes/polygon_mesh.h). Elements and
// properties may come in any order. All other properties, colours too, and other elements are left out with a
// note. Lines of the header that are no statement, and in text other types than PLY's and normals that are
// not of theirs, are replaced and counted (docs/scenes.md, FileOptions::strict). A PLY file has no materials:
// all is matt grey (0.8), as an OBJ file's faces without one. A file whose vertices are Gaussians
// (ply_gaussians.h) needs no faces; it becomes Scene::gaussians and their proxies.
#pragma once

#include <filesystem>

#include "scenes/animated.h"
#include "scenes/file_options.h"

namespace marti::scenes {

/// Opens a file, which has one pose, no camera and no light: it gets those that open_gltf gives. Polygons
/// with a position that is not finite are left out, with a note. Throws UserError, beginning with the file's
/// path and, for a fault in it, the line or the byte; no input makes it crash or loop.
[[nodiscard]] AnimatedScene open_ply(const std::filesystem::path& path, const FileOptions& options);

}  // namespace marti::scenes
