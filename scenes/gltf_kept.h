// Internal to scenes/: which meshes of a glTF file are kept once for all nodes that share them.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "scenes/gltf_mesh.h"
#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/scene.h"

namespace marti::scenes::gltf {

/// A mesh is kept if two nodes or more share it, none of its materials emits light (each point of a light is
/// a place of its own), it has no morph targets, and rays can be turned into each node's place
/// (why_not_kept); skinned nodes have vertices of their own. All other meshes are copied, as one.
class KeptMeshes {
 public:
  /// By the pose in which the scene is read. Nothing is kept where FileOptions::instances says so.
  KeptMeshes(const Model& model, const std::vector<SceneNode>& nodes, const Pose& pose);

  /// Whether the mesh of the node `place` is left to add().
  [[nodiscard]] bool keeps(std::size_t place) const { return kept_[place]; }
  /// The nodes whose meshes take room of their own: of those that share a kept mesh the first.
  [[nodiscard]] std::vector<SceneNode> distinct(const std::vector<SceneNode>& nodes) const;
  /// Adds the kept meshes behind what is in the scene, each in its own coordinates, and all instances.
  void add(MeshReader& reader, Pose& pose, Scene& scene);
  /// Puts the instances of the scene where they are in another pose. Throws KeyError about
  /// structure.instances when one cannot be kept there.
  void move(const Pose& pose, Scene& scene) const;

 private:
  std::vector<bool> kept_;                          // by place
  std::map<int, std::vector<std::size_t>> places_;  // of each kept mesh
  std::vector<std::size_t> order_;  // places of the kept instances as they follow in the scene
};

}  // namespace marti::scenes::gltf
