// Reading Wavefront OBJ files with material libraries (.obj, .mtl; Object Files and Material Library File
// Format, Alias | Wavefront 4.2, 1995).
//
// The reader is our own, not tinyobjloader (version 2.0.0rc10 in Debian 12): that one turns a word that is no
// number into 0, passes over statements that it does not know, gives faces of an unknown material none, and
// its messages are warnings, most without a line. Here each of these is refused with file and line, or, if
// the scene can be made without it, replaced and counted: libraries and textures that cannot be read, unknown
// materials and the like (docs/scenes.md, FileOptions::strict).
//
// Read: v, vn, vt; f with any number of corners (scenes/polygon_mesh.h), also counted back from the last
// vertex; mtllib, usemtl. o, g and s change nothing: without normals a face is flat, whatever its smoothing
// group. Left out with a note: colours and weights of vertices, points, lines, free-form curves and surfaces,
// settings of the display. All else is refused. The text is UTF-8, or UTF-16 with its byte order mark.
// Lengths and directions are taken as they are, colours as linear ones, textures as sRGB; v of a texture
// coordinate goes up, and is turned.
//
// Materials. Kd is the colour, with weight d (or 1 - Tr); the largest channel of Ks is the weight of the
// highlight (illum 2 and above) and of reflection (illum 3 to 9), Ks divided by it their colour; the exponent
// is Ns, or 1 if that is more. What d leaves of 1 is transmitted: refracted by Ni with illum 4, 6, 7 and 9,
// else straight on. With illum 6 and 7 so is (1 - Ks) Tf, if that is more. Ke is emission; map_Kd is a
// texture. With map_d a face is cut out where d times its texel (the mean of its colours; with -imfchan m, or
// of the file of map_Kd, its alpha) is below 0.5, and opaque elsewhere. A material library may read textures
// in the scene's folder and below, as a glTF file may. A face before the first usemtl is matt grey (0.8).
#pragma once

#include <filesystem>

#include "scenes/animated.h"
#include "scenes/file_options.h"
#include "scenes/texture.h"

namespace marti::scenes {

/// Opens a file, which has one pose, no camera and no light: it gets those that open_gltf gives. Polygons
/// with a position that is not finite are left out, with a note. Throws UserError, beginning with the file's
/// path and mostly a line, for anything missing, broken, out of range or not supported; no input makes it
/// crash or loop.
[[nodiscard]] AnimatedScene open_obj(const std::filesystem::path& path, const FileOptions& options,
                                     const ImageDecoder& decode);

}  // namespace marti::scenes
