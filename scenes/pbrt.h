// Reading the scene files of pbrt (.pbrt; version 4, pbrt.org/fileformat-v4).
//
// The reader is our own: pbrt's parser comes with pbrt alone, and no library of Debian 12 reads the format.
//
// Read: the shapes trianglemesh, plymesh, bilinearmesh (two triangles a patch), sphere, cylinder, disk and,
// as its control mesh, loopsubdiv, curved ones that shine as triangles, which paths find; all transforms,
// objects and their instances, Attribute, Include and Import; the perspective camera, with `fov` along the
// shorter side of the film; point, distant and spot lights, area lights, and an infinite light without an
// image as a sky; materials and textures as pbrt_material.h says, spectra as pbrt_color.h does. Of version 3,
// the materials matte, plastic, substrate, uber, mirror, glass and metal. Left out with a note: curves,
// media, motion; area lights shine on both sides; what else is replaced stands in docs/scenes.md. Statements
// that say how pbrt renders change nothing.
//
// pbrt's coordinates are left-handed. Where its camera sees a right-handed world mirrored, the scene is
// mirrored in x, so that the image is that of pbrt. A light of intensity I shines with I / pi, so that a
// surface of albedo a reflects a I / pi, as in pbrt; radiances are taken as they are.
#pragma once

#include <filesystem>
#include <string_view>

#include "scenes/animated.h"
#include "scenes/file_options.h"
#include "scenes/texture.h"

namespace marti::scenes {

/// The note of a scene that is mirrored.
inline constexpr std::string_view mirrored_note =
    "The scene is mirrored in x, as its camera, which is left-handed, sees it.";

/// Opens a file, which has one pose. A scene without a perspective camera gets one that sees all of it. The
/// files that it names lie in its folder or below. Throws UserError, beginning with the file's path and
/// mostly a line, for anything missing, broken, out of range or not supported; no input makes it crash or
/// loop.
[[nodiscard]] AnimatedScene open_pbrt(const std::filesystem::path& path, const FileOptions& options,
                                      const ImageDecoder& decode);

}  // namespace marti::scenes
