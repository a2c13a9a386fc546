// Internal to scenes/: which parts of a file its scene uses, and which the loader has not read.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/animated.h"
#include "scenes/gltf_material.h"
#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"

namespace marti::scenes::gltf {

/// What the loader counted while it read the scene.
struct Chosen {
  std::uint64_t skins = 0;
  std::uint64_t animations = 0;
  std::uint64_t cameras = 0;
};

/// Call it when the scene has been read, and before read_unused(). The size of an accessor that was not read
/// is its declared one, limited by its buffer, because it has not been checked.
[[nodiscard]] FileUse use_of(const Model& model, const std::vector<SceneNode>& nodes,
                             const Materials& materials, const Chosen& chosen);

/// Reads the accessors that were not read and decodes the images that are not used. Throws UserError for
/// their faults. Skips matrices of 2 x 2 and 3 x 3 numbers, which nothing in glTF uses.
void read_unused(const Model& model, const Materials& materials);

}  // namespace marti::scenes::gltf
