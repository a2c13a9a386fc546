// Inside of the folder: meshes of a glTF file as triangles of a scene.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "scenes/gltf_material.h"
#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/scene.h"

namespace marti::scenes::gltf {

class MeshReader {
 public:
  MeshReader(const Model& model, Materials& materials, Scene& scene, LeftOut& left_out)
      : model_(model), materials_(materials), scene_(scene), left_out_(left_out) {}

  /// Adds the triangles of one instance of a mesh.
  void add(int mesh, const PlacedNode& place);

  /// Triangles left out because a position is not finite (or beyond 1e30).
  [[nodiscard]] std::uint64_t bad_triangles() const { return bad_triangles_; }

 private:
  struct Vertices {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  using VertexKey = std::tuple<int, int, int>;  // accessors of positions, normals, texture coordinates

  void add_primitive(const tinygltf::Primitive& primitive, const PlacedNode& place, const std::string& name,
                     std::map<VertexKey, Vertices>& shared);
  Vertices add_vertices(const VertexKey& key, const PlacedNode& place, const std::string& name);
  void add_normals(int accessor, const Vertices& vertices, const PlacedNode& place, const std::string& name);
  void add_coordinates(int accessor, const Vertices& vertices, const std::string& name);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material);

  const Model& model_;
  Materials& materials_;
  Scene& scene_;
  LeftOut& left_out_;
  std::vector<char> bad_vertex_;
  std::uint64_t bad_triangles_ = 0;
  std::uint64_t visits_ = 0;  // of primitives, in all instances
};

}  // namespace marti::scenes::gltf
