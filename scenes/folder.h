// Reading a folder of scene files as one scene.
#pragma once

#include <filesystem>

#include "scenes/animated.h"
#include "scenes/file_options.h"
#include "scenes/texture.h"

namespace marti::scenes {

/// Opens all files of the folder, but of no folder in it, whose names end in one of `file_endings`
/// (scenes/open.h) but .pbrt, in the order of their names' bytes, as one scene of one pose (merged_scene.h),
/// all in the same space. If none has a camera, and for lights, the scene gets what a file without them gets.
/// Files without triangles are left out with a note; a note of a file begins with its name. Throws UserError,
/// beginning with the folder's path or that of a file in it, when the folder cannot be read, has no such file
/// or more than most_parts, when none has triangles, and for what the readers of the files refuse.
[[nodiscard]] AnimatedScene open_folder(const std::filesystem::path& path, const FileOptions& options,
                                        const ImageDecoder& decode);

}  // namespace marti::scenes
