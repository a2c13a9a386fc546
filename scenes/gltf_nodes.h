// Inside of the folder: the node hierarchy of a glTF file.
#pragma once

#include <vector>

#include <glm/mat4x4.hpp>

#include "scenes/gltf_model.h"

namespace marti::scenes::gltf {

/// A node of the chosen scene and its transform to world space.
struct PlacedNode {
  int node = 0;
  glm::dmat4 world{1.0};
};

/// The nodes of the chosen scene, parents before children, in the file's order. Throws UserError for a
/// scene that is not there, nodes with two parents, cycles, and transforms that are not finite.
[[nodiscard]] std::vector<PlacedNode> place_nodes(const Model& model);

/// The index that `choice` means in a list of named things: a number or a name. Throws UserError.
[[nodiscard]] int chosen_index(const Model& model, const std::string& choice, const char* kind,
                               const std::vector<std::string>& names);

}  // namespace marti::scenes::gltf
