// Internal to scenes/: skins of a glTF file (glTF 2.0.1, section 3.7.3).
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include <glm/mat4x4.hpp>

#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"

namespace marti::scenes::gltf {

/// The skins used by meshes of the scene, each read once.
class Skins {
 public:
  /// Both arguments must outlive this object.
  Skins(const Model& model, const std::vector<SceneNode>& nodes) : model_(model), nodes_(nodes) {}

  /// The place of one of the file's skins, for `matrices`. Throws UserError when the skin is broken.
  std::size_t use(int skin, int node);

  [[nodiscard]] std::size_t size() const { return skins_.size(); }
  [[nodiscard]] std::size_t joints(std::size_t place) const { return skins_[place].joints.size(); }

  /// For each joint of a skin in use, the matrix from the mesh in its bind pose to world space: the inverse
  /// bind matrix, followed by the joint's own transform.
  [[nodiscard]] std::vector<glm::dmat4> matrices(std::size_t place,
                                                 const std::vector<PlacedNode>& placed) const;

 private:
  struct Skin {
    std::vector<std::size_t> joints;  // places among the scene's nodes
    std::vector<glm::dmat4> inverse_bind;
  };
  Skin read(int skin, int node);

  const Model& model_;
  const std::vector<SceneNode>& nodes_;
  std::map<int, std::size_t> place_of_node_;  // filled at the first use
  std::map<int, std::size_t> used_;
  std::vector<Skin> skins_;
};

}  // namespace marti::scenes::gltf
