#include "scenes/gltf_instances.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "scenes/gltf_vertices.h"

namespace marti::scenes::gltf {

namespace {

/// The number of an accessor's elements; std::nullopt without accessor. Faults are found when it is read.
std::optional<std::uint64_t> count_of(const tinygltf::Model& file, int accessor) {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= file.accessors.size()) {
    return std::nullopt;
  }
  const tinygltf::Accessor& a = file.accessors[static_cast<std::size_t>(accessor)];
  const auto view = static_cast<std::size_t>(a.bufferView);
  std::uint64_t most = most_zeros;
  if (a.bufferView >= 0 && view < file.bufferViews.size()) {
    const auto buffer = static_cast<std::size_t>(file.bufferViews[view].buffer);
    most = buffer < file.buffers.size() ? file.buffers[buffer].data.size() : 0;
  }
  return std::min<std::uint64_t>(a.count, most);
}

/// Bytes of a vertex in a VertexSource: three vectors, two for each morph target, and four joints with their
/// weights for each set of them.
std::uint64_t source_bytes(const tinygltf::Primitive& primitive) {
  constexpr std::uint64_t vector = sizeof(glm::dvec3);
  std::uint64_t sets = 0;
  for (const auto& [semantic, accessor] : primitive.attributes) {
    sets += semantic.starts_with("JOINTS_") ? 1U : 0U;
  }
  return 3 * vector + primitive.targets.size() * 2 * vector +
         sets * 4 * (sizeof(std::uint32_t) + sizeof(double));
}

/// The size of a mesh, as instantiated by each of its nodes.
Expanded expanded_mesh(const tinygltf::Model& file, const tinygltf::Mesh& mesh) {
  Expanded expanded;
  // Primitives of a node share vertices if all their data come from the same accessors.
  std::set<std::pair<std::map<std::string, int>, std::vector<std::map<std::string, int>>>> shared;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    const std::optional<std::uint64_t> vertices = count_of(file, attribute(primitive.attributes, "POSITION"));
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES || !vertices) {
      continue;
    }
    const std::uint64_t corners = count_of(file, primitive.indices).value_or(*vertices);
    if (shared.emplace(primitive.attributes, primitive.targets).second) {
      expanded.vertices += *vertices;
      expanded.source_bytes += *vertices * source_bytes(primitive);
    }
    expanded.triangles += primitive.mode == TINYGLTF_MODE_TRIANGLES ? corners / 3 : corners;
    expanded.normals = expanded.normals || attribute(primitive.attributes, "NORMAL") >= 0;
    expanded.coordinates = expanded.coordinates || attribute(primitive.attributes, "TEXCOORD_0") >= 0;
  }
  return expanded;
}

}  // namespace

std::uint64_t Expanded::bytes() const {
  constexpr std::uint64_t vector = sizeof(glm::dvec3);
  const std::uint64_t vertex = vector + 1 + (normals ? vector : 0) + (coordinates ? sizeof(glm::dvec2) : 0);
  // Twice: for the scene that is kept and for the one that is returned.
  return 2 * (vertices * vertex + triangles * sizeof(Triangle)) + source_bytes;
}

Expanded expanded_instances(const Model& model, const std::vector<SceneNode>& nodes) {
  const tinygltf::Model& file = model.data();
  Expanded all;
  std::map<int, Expanded> known;
  for (const SceneNode& node : nodes) {
    const int mesh = node.mesh;
    if (mesh < 0 || static_cast<std::size_t>(mesh) >= file.meshes.size()) {
      continue;
    }
    auto found = known.find(mesh);
    if (found == known.end()) {
      found = known.emplace(mesh, expanded_mesh(file, file.meshes[static_cast<std::size_t>(mesh)])).first;
      all.source_bytes += found->second.source_bytes;
    }
    all.vertices += found->second.vertices;
    all.triangles += found->second.triangles;
    all.normals = all.normals || found->second.normals;
    all.coordinates = all.coordinates || found->second.coordinates;
  }
  // The loader refuses more.
  all.vertices = std::min(all.vertices, model.options().max_triangles);
  all.triangles = std::min(all.triangles, model.options().max_triangles);
  return all;
}

}  // namespace marti::scenes::gltf
