// Inside of the folder: what of a file its scene uses, and what nobody has read.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/animated.h"
#include "scenes/gltf_material.h"
#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"

namespace marti::scenes::gltf {

/// What the loader itself has counted while it read the scene.
struct Chosen {
  std::uint64_t skins = 0;
  std::uint64_t animations = 0;
  std::uint64_t cameras = 0;
};

/// To be asked when the scene has been read, and before read_unused(). The bytes of an accessor that nobody
/// has read are what it says, at most those of its buffer: it has not been checked.
[[nodiscard]] FileUse use_of(const Model& model, const std::vector<SceneNode>& nodes,
                             const Materials& materials, const Chosen& chosen);

/// Reads the accessors that nobody has read and decodes the images that nobody uses. Throws UserError for
/// what is wrong with them. Matrices of 2 x 2 and 3 x 3 numbers, which nothing in glTF has, are passed over.
void read_unused(const Model& model, const Materials& materials);

}  // namespace marti::scenes::gltf
