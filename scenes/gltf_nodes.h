// Inside of the folder: the node hierarchy of a glTF file.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "scenes/gltf_model.h"

namespace marti::scenes::gltf {

/// A node of the chosen scene and its place among those.
struct SceneNode {
  int node = 0;
  int parent = -1;  ///< index of the parent in the list of the scene's nodes, -1 for a root
};

/// A node of the chosen scene and its transform to world space.
struct PlacedNode {
  int node = 0;
  glm::dmat4 world{1.0};
};

/// What an animation changes of a node at one time. The rest stays as the file has it.
struct NodeChange {
  std::optional<glm::dvec3> translation;
  std::optional<glm::dvec4> rotation;  ///< a quaternion x, y, z, w, of any length above 0
  std::optional<glm::dvec3> scale;
  std::vector<double> weights;  ///< of morph targets; empty: not changed
};
using NodeChanges = std::map<int, NodeChange>;  ///< by node

/// The nodes of the chosen scene, parents before children, in the file's order. Throws UserError for a
/// scene that is not there, nodes with two parents, and cycles.
[[nodiscard]] std::vector<SceneNode> nodes_of_scene(const Model& model);

/// Their transforms. Throws UserError for one that is not finite.
[[nodiscard]] std::vector<PlacedNode> place_nodes(const Model& model, const std::vector<SceneNode>& nodes,
                                                  const NodeChanges& changes);

/// The index that `choice` means in a list of named things: a number or a name. Throws UserError.
[[nodiscard]] int chosen_index(const Model& model, const std::string& choice, const char* kind,
                               const std::vector<std::string>& names);

}  // namespace marti::scenes::gltf
