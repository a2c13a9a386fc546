// Internal to scenes/: files of LumiBench (Liu et al., "LumiBench: A Benchmark Suite for Hardware Ray
// Tracing", IISWC 2023) that hold a camera.
#pragma once

#include <filesystem>

#include "scenes/camera.h"
#include "scenes/file_options.h"

namespace marti::scenes {

/// Reads six numbers, separated by blanks and ends of lines: where the eye is and a point that it looks at.
/// Up is +y, the field of view that of a Camera. Throws UserError with file and line when they are fewer or
/// more, not numbers or beyond 1e30, or span no view.
[[nodiscard]] Camera read_camera_file(const std::filesystem::path& path, const FileOptions& options);

}  // namespace marti::scenes
