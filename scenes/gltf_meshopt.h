// Internal to scenes/: buffer views that are compressed by EXT_meshopt_compression or its Khronos twin
// KHR_meshopt_compression, with the library meshoptimizer.
#pragma once

#include <tiny_gltf.h>

#include "scenes/source_file.h"

namespace marti::scenes::gltf {

/// Whether marti was built with the library.
[[nodiscard]] bool has_meshopt();

/// Gives each compressed view whose buffer has no bytes a buffer of its own, decompressed. Throws UserError.
/// The bytes are those that the file declares, so an accessor's checks hold for them as for others.
void decompress_views(const SourceFile& source, tinygltf::Model& file);

}  // namespace marti::scenes::gltf
