// Internal to scenes/: the files that a glTF file may refer to, for tinygltf.
#pragma once

#include <tiny_gltf.h>

#include "scenes/file_access.h"

namespace marti::scenes::gltf {

/// The callbacks with which tinygltf reads files. They refer to `access`. A URI may be escaped, as "%2e%2e".
[[nodiscard]] tinygltf::FsCallbacks callbacks_of(FileAccess& access);

}  // namespace marti::scenes::gltf
