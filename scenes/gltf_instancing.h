// Internal to scenes/: nodes whose mesh stands in many places (EXT_mesh_gpu_instancing).
#pragma once

#include <vector>

#include <glm/mat4x4.hpp>

#include "scenes/gltf_model.h"

namespace marti::scenes::gltf {

/// Where the mesh of a node stands, relative to the node, in the order of the extension's attributes
/// TRANSLATION, ROTATION and SCALE; others are passed over. Throws UserError when the attributes are of
/// different lengths, not finite or no rotations, and for a node with a skin, whose transform does not count.
[[nodiscard]] std::vector<glm::dmat4> instance_transforms(const Model& model, int node);

/// Whether the node has the extension and a mesh; without a mesh the extension stands for nothing.
[[nodiscard]] bool is_instanced(const tinygltf::Node& node);

}  // namespace marti::scenes::gltf
