// Internal to scenes/: vertices of meshes as in the file, and their positions in a pose. Displacements of
// morph targets are applied first, then the joints or else the node's transform (glTF 2.0.1, sections
// 3.7.2.2, 3.7.3.3).
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/scene.h"

namespace marti::scenes::gltf {

/// The file's accessor for an attribute, -1 when there is none.
[[nodiscard]] int attribute(const std::map<std::string, int>& attributes, const std::string& name);

/// Whether the transform reverses the winding of triangles.
[[nodiscard]] bool is_mirrored(const glm::dmat4& world);

/// The displacements of one morph target; each list is empty or as long as the vertices.
struct MorphTarget {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;
};

/// Vertices in the mesh's own space, shared by all primitives with the same accessors.
struct VertexSource {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;  ///< empty or as long as `positions`
  std::vector<MorphTarget> targets;
  std::size_t influences = 0;         ///< joints per vertex; 0 without a skin
  std::vector<std::uint32_t> joints;  ///< `influences` for each vertex, indices into the skin's joints
  std::vector<double> weights;        ///< `influences` for each vertex, which add up to 1
  std::uint32_t highest_joint = 0;
};

/// One use of vertices in the scene.
struct VertexInstance {
  std::shared_ptr<const VertexSource> source;
  std::uint32_t first = 0;  ///< index into Scene::positions
  std::size_t place = 0;    ///< number of its node among the scene's nodes
  int skin = -1;            ///< number among the skins in use; -1: the node's transform is used
  const std::vector<double>* weights = nullptr;  ///< of the morph targets, unless the pose has its own
};

/// The state of a scene's nodes at one time.
struct Pose {
  NodeChanges changes;
  std::vector<PlacedNode> nodes;                ///< parallel to the scene's nodes
  std::vector<std::vector<glm::dmat4>> joints;  ///< of each skin in use
};

/// Reads vertices and keeps their sum within the file's limits.
class VertexReader {
 public:
  explicit VertexReader(const Model& model) : model_(model) {}

  /// Throws UserError; `name` names the primitive in it. Joints are read only if `skinned`.
  std::shared_ptr<const VertexSource> read(const tinygltf::Primitive& primitive, bool skinned,
                                           const std::string& name);

  /// Counts one more instance of the vertices, so that the time is bounded too.
  void charge_instance(const VertexSource& source) {
    charge(source.positions.size() * (source.targets.size() + source.influences));
  }

 private:
  using Key = std::vector<int>;  // all accessors with data of the vertices
  void charge(std::uint64_t work);
  /// `exact`: the buffer view of exact_view(), or -1.
  std::vector<glm::dvec3> read_vectors(int accessor, int exact, const std::string& name) const;
  /// As many vectors as there are positions; `what` names them in the plural.
  std::vector<glm::dvec3> read_counted(int accessor, int exact, std::size_t count, const std::string& name,
                                       const char* what) const;
  void read_targets(const tinygltf::Primitive& primitive, VertexSource& source,
                    const std::string& name) const;
  void read_influences(const tinygltf::Primitive& primitive, VertexSource& source,
                       const std::string& name) const;

  const Model& model_;
  std::map<Key, std::shared_ptr<const VertexSource>> known_;
  std::uint64_t work_ = 0;
};

/// Writes positions and, if there are any, normals of an instance to the scene, whose vectors are long
/// enough. A position that is not finite or beyond 1e30 becomes 0 and its entry of `bad` becomes 1.
void pose_vertices(const VertexInstance& instance, const Pose& pose, Scene& scene, std::vector<char>& bad);

}  // namespace marti::scenes::gltf
