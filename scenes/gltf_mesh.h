// Internal to scenes/: meshes of a glTF file as triangles of a scene.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenes/gltf_material.h"
#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/gltf_skin.h"
#include "scenes/gltf_vertices.h"
#include "scenes/scene.h"

namespace marti::scenes::gltf {

/// Consecutive triangles that belong to one node without a skin.
struct TriangleRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::size_t place = 0;  ///< of the node among the scene's nodes
  bool mirrored = false;  ///< whether their winding is reversed relative to the file
};

class MeshReader {
 public:
  /// All arguments must outlive this object.
  MeshReader(const Model& model, Materials& materials, Skins& skins, Scene& scene, LeftOut& left_out)
      : model_(model),
        materials_(materials),
        skins_(skins),
        scene_(scene),
        left_out_(left_out),
        vertices_(model) {}

  /// Adds the triangles of the mesh of a node, with vertices placed as in `pose`; adds the skins it uses to
  /// the pose.
  void add(std::size_t place, Pose& pose);

  /// Triangles left out because a position is not finite (or beyond 1e30).
  [[nodiscard]] std::uint64_t bad_triangles() const { return bad_triangles_; }

  /// The data for placing the vertices in another pose.
  [[nodiscard]] const std::vector<VertexInstance>& instances() const { return instances_; }
  [[nodiscard]] const std::vector<TriangleRange>& ranges() const { return ranges_; }
  [[nodiscard]] std::uint64_t morph_targets() const { return morph_targets_; }

 private:
  struct Vertices {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  struct Coordinates {  // of textures
    int accessor = -1;
    int exact = -1;  // the buffer view of exact_view()
    TextureTransform transform;
    auto operator<=>(const Coordinates&) const = default;
  };
  struct User {  // the node whose mesh is added
    std::size_t place = 0;
    int skin = -1;
    const std::vector<double>* weights = nullptr;
    std::map<std::pair<const VertexSource*, Coordinates>, Vertices> shared;
  };

  void add_primitive(const tinygltf::Primitive& primitive, const Pose& pose, const std::string& name,
                     User& user);
  Vertices add_vertices(std::shared_ptr<const VertexSource> source, Coordinates coordinates, const Pose& pose,
                        const std::string& name, const User& user);
  void add_coordinates(Coordinates coordinates, const Vertices& vertices, const std::string& name);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material);

  const Model& model_;
  Materials& materials_;
  Skins& skins_;
  Scene& scene_;
  LeftOut& left_out_;
  VertexReader vertices_;
  std::vector<VertexInstance> instances_;
  std::vector<TriangleRange> ranges_;
  std::map<int, std::size_t> targets_;  // morph targets of the meshes met so far
  std::uint64_t morph_targets_ = 0;
  std::vector<char> bad_vertex_;
  std::uint64_t bad_triangles_ = 0;
  std::uint64_t visits_ = 0;  // number of primitives visited, in all instances
};

}  // namespace marti::scenes::gltf
