// Internal to scenes/: the node hierarchy of a glTF file.
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

/// A node of the chosen scene and its place in the list of the scene's nodes.
struct SceneNode {
  int node = 0;
  int parent = -1;  ///< index of the parent in the list of the scene's nodes, -1 for a root
};

/// A node of the chosen scene and its transform to world space.
struct PlacedNode {
  int node = 0;
  glm::dmat4 world{1.0};
};

/// Whether a rotation's quaternion, a unit one by the format, has a length that can be brought to 1.
[[nodiscard]] inline bool is_usable_quaternion(double length) { return length > 1e-6 && length < 1e6; }

/// The properties of a node that an animation changes, at one time. Others are as in the file.
struct NodeChange {
  std::optional<glm::dvec3> translation;
  std::optional<glm::dvec4> rotation;  ///< a quaternion x, y, z, w, of any length above 0
  std::optional<glm::dvec3> scale;
  std::vector<double> weights;  ///< of morph targets; empty: unchanged
};
using NodeChanges = std::map<int, NodeChange>;  ///< by node

/// The nodes of the chosen scene, parents before children, in the file's order. Throws UserError for a scene
/// that does not exist, nodes with two parents, and cycles.
[[nodiscard]] std::vector<SceneNode> nodes_of_scene(const Model& model, LeftOut& left_out);

/// The nodes' transforms. Throws UserError for one that is not finite.
[[nodiscard]] std::vector<PlacedNode> place_nodes(const Model& model, const std::vector<SceneNode>& nodes,
                                                  const NodeChanges& changes);

/// The index of the element that `choice`, a number or a name, selects in a list. Throws UserError.
[[nodiscard]] int chosen_index(const Model& model, const std::string& choice, const char* kind,
                               const std::vector<std::string>& names);

}  // namespace marti::scenes::gltf
