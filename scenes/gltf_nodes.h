// Internal to scenes/: the node hierarchy of a glTF file.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "scenes/gltf_model.h"

namespace marti::scenes::gltf {

/// A node of the chosen scene and its place in the list of the scene's nodes.
struct SceneNode {
  int node = 0;
  int parent = -1;  ///< index of the parent in the list of the scene's nodes, -1 for a root
  int mesh = -1;    ///< that stands here, -1 for none
  /// One of the places of its parent's mesh (gltf_instancing.h), and no node of the file: `node` is its
  /// parent's.
  std::optional<glm::dmat4> place = std::nullopt;
};

/// A node of the chosen scene and its transform to world space.
struct PlacedNode {
  int node = 0;
  bool of_file = true;  ///< false for one of the places of a node's mesh, where its camera and light are not
  glm::dmat4 world{1.0};
};

/// Whether a rotation's quaternion, a unit one by the format, has a length that can be brought to 1.
[[nodiscard]] inline bool is_usable_quaternion(double length) { return length > 1e-6 && length < 1e6; }

/// A transform by its parts.
struct Transform {
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z
  glm::dvec3 scale{1.0};

  /// std::nullopt if the rotation is no usable quaternion (is_usable_quaternion).
  [[nodiscard]] std::optional<glm::dmat4> matrix() const;
};

/// The properties of a node that an animation changes, at one time. Others are as in the file.
struct NodeChange {
  std::optional<glm::dvec3> translation;
  std::optional<glm::dvec4> rotation;  ///< a quaternion x, y, z, w, of any length above 0
  std::optional<glm::dvec3> scale;
  std::vector<double> weights;  ///< of morph targets; empty: unchanged
};
using NodeChanges = std::map<int, NodeChange>;  ///< by node

/// The nodes of the chosen scene, parents before children, in the file's order; behind a node whose mesh has
/// places of its own those, in its stead. Throws UserError for a scene that does not exist, nodes with two
/// parents, and cycles.
[[nodiscard]] std::vector<SceneNode> nodes_of_scene(const Model& model, LeftOut& left_out);

/// The nodes' transforms. Throws UserError for one that is not finite.
[[nodiscard]] std::vector<PlacedNode> place_nodes(const Model& model, const std::vector<SceneNode>& nodes,
                                                  const NodeChanges& changes);

/// The index of the element that `choice`, a number or a name, selects in a list. Throws UserError.
[[nodiscard]] int chosen_index(const Model& model, const std::string& choice, const char* kind,
                               const std::vector<std::string>& names);

}  // namespace marti::scenes::gltf
