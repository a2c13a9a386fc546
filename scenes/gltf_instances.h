// Inside of the folder: how large a scene becomes when every node has vertices and triangles of its own.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"

namespace marti::scenes::gltf {

struct Expanded {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t sources = 0;  ///< vertices of the meshes themselves, once each
  bool normals = false;
  bool coordinates = false;

  /// What the scene, a copy of it for a pose, and the meshes' own vertices take.
  [[nodiscard]] std::uint64_t bytes() const;
};

/// Counted from what the accessors say, at most what their buffer views hold, without reading vertices.
[[nodiscard]] Expanded expanded_instances(const Model& model, const std::vector<SceneNode>& nodes);

}  // namespace marti::scenes::gltf
