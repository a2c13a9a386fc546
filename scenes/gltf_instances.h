// Internal to scenes/: the size of a scene when every node gets vertices and triangles of its own.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"

namespace marti::scenes::gltf {

struct Expanded {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t source_bytes = 0;  ///< of the meshes' own vertices, each counted once
  bool normals = false;
  bool coordinates = false;

  /// Bytes for the scene, a copy of it for a pose, and the meshes' own vertices.
  [[nodiscard]] std::uint64_t bytes() const;
};

/// Counted from the accessors' declared sizes, limited by their buffer views, without reading vertices.
[[nodiscard]] Expanded expanded_instances(const Model& model, const std::vector<SceneNode>& nodes);

}  // namespace marti::scenes::gltf
