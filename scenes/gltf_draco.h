// Internal to scenes/: primitives that are compressed by KHR_draco_mesh_compression, with the library Draco.
#pragma once

#include <tiny_gltf.h>

#include "scenes/gltf_model.h"

namespace marti::scenes::gltf {

/// Whether marti was built with the library.
[[nodiscard]] bool has_draco();

/// Gives the accessors of each compressed primitive buffers of their own, decompressed, where they have no
/// bytes. Throws UserError. Sizes are checked against what the accessors declare before anything is
/// decompressed. `file` is the model's data.
void decompress_primitives(const Model& model, tinygltf::Model& file);

}  // namespace marti::scenes::gltf
