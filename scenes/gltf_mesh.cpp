#include "scenes/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace marti::scenes::gltf {

namespace {

// Beyond this, products of three differences of coordinates could overflow.
constexpr double largest_coordinate = 1e30;

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

bool is_usable(const glm::dvec3& p) {
  return std::abs(p.x) <= largest_coordinate && std::abs(p.y) <= largest_coordinate &&
         std::abs(p.z) <= largest_coordinate;
}

/// The inverse transpose of the upper 3 x 3 part up to a positive factor: its cofactors, negated for a
/// mirroring transform. Needs no division, so a flattening transform does no harm.
glm::dmat3 normal_transform(const glm::dmat4& world) {
  const glm::dmat3 m(world);
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], cofactors[0]) < 0.0 ? -cofactors : cofactors;
}

bool is_mirrored(const glm::dmat4& world) {
  const glm::dmat3 m(world);
  return glm::dot(m[0], glm::cross(m[1], m[2])) < 0.0;
}

}  // namespace

void MeshReader::add(int mesh, const PlacedNode& place) {
  const tinygltf::Mesh& source =
      model_.at(model_.data().meshes, mesh, "mesh", "node " + std::to_string(place.node));
  std::map<VertexKey, Vertices> shared;
  // Primitives that give no triangle would else be free: many nodes times many points take for ever.
  visits_ += source.primitives.size();
  if (visits_ > model_.options().max_triangles) {
    model_.fail("the scene has more than " + std::to_string(model_.options().max_triangles) +
                " primitives, which is more than is accepted");
  }
  for (std::size_t i = 0; i < source.primitives.size(); ++i) {
    const std::string name = "mesh " + std::to_string(mesh) + ", primitive " + std::to_string(i);
    add_primitive(source.primitives[i], place, name, shared);
  }
}

void MeshReader::add_primitive(const tinygltf::Primitive& primitive, const PlacedNode& place,
                               const std::string& name, std::map<VertexKey, Vertices>& shared) {
  if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    model_.fail(name + ": there is no primitive mode " + std::to_string(primitive.mode));
  }
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
    left_out_.features["primitives of points or lines"] += 1;
    return;
  }
  VertexKey key{attribute(primitive, "POSITION"), attribute(primitive, "NORMAL"), -1};
  if (std::get<0>(key) < 0) {
    left_out_.features["primitives without positions"] += 1;
    return;
  }
  left_out_.features["morph targets"] += primitive.targets.size();
  left_out_.features["vertex colours"] += attribute(primitive, "COLOR_0") >= 0 ? 1U : 0U;
  const Materials::Use use = materials_.use(primitive.material);
  if (use.texture_coordinates >= 0) {
    std::get<2>(key) = attribute(primitive, "TEXCOORD_" + std::to_string(use.texture_coordinates));
    left_out_.features["textures on primitives without the texture coordinates for them"] +=
        std::get<2>(key) < 0 ? 1U : 0U;
  }
  auto known = shared.find(key);
  if (known == shared.end()) {
    known = shared.emplace(key, add_vertices(key, place, name)).first;
  }
  const Vertices vertices = known->second;

  std::vector<std::uint32_t> indices;
  if (primitive.indices >= 0) {
    indices = model_.read_indices(primitive.indices, name + ": its indices");
    for (const std::uint32_t index : indices) {
      if (index >= vertices.count) {
        model_.fail(name + ": vertex index " + std::to_string(index) + " is out of range; it has " +
                    std::to_string(vertices.count) + " vertices");
      }
    }
  }
  const std::size_t corners = primitive.indices >= 0 ? indices.size() : vertices.count;
  const auto corner = [&](std::size_t i) {
    return vertices.first + (primitive.indices >= 0 ? indices[i] : static_cast<std::uint32_t>(i));
  };
  const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
  if (corners < 3 || (is_list && corners % 3 != 0)) {
    model_.fail(name + ": " + std::to_string(corners) + " corners do not make triangles");
  }
  const bool mirrored = is_mirrored(place.world);
  const std::size_t count = is_list ? corners / 3 : corners - 2;
  for (std::size_t i = 0; i < count; ++i) {
    // The orders of glTF 2.0, section 3.7.2.1.
    std::array<std::size_t, 3> at = {3 * i, 3 * i + 1, 3 * i + 2};
    if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      at = {i, i + 1 + i % 2, i + 2 - i % 2};
    } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      at = {i + 1, i + 2, 0};
    }
    if (mirrored) {
      std::swap(at[1], at[2]);
    }
    add_triangle(corner(at[0]), corner(at[1]), corner(at[2]), use.material);
  }
}

MeshReader::Vertices MeshReader::add_vertices(const VertexKey& key, const PlacedNode& place,
                                              const std::string& name) {
  const auto& [position, normal, coordinates] = key;
  const std::vector<double> values = model_.read_values(position, 3, name + ": POSITION");
  const std::size_t count = values.size() / 3;
  if (scene_.positions.size() + count > model_.options().max_triangles) {
    model_.fail("the scene has more than " + std::to_string(model_.options().max_triangles) +
                " vertices, which is more than is accepted");
  }
  const Vertices vertices{static_cast<std::uint32_t>(scene_.positions.size()),
                          static_cast<std::uint32_t>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 p(place.world * glm::dvec4(values[3 * i], values[3 * i + 1], values[3 * i + 2], 1.0));
    const bool usable = is_usable(p);
    bad_vertex_.push_back(usable ? 0 : 1);
    scene_.positions.push_back(usable ? p : glm::dvec3(0.0));
  }
  if (normal >= 0) {
    add_normals(normal, vertices, place, name);
  }
  if (coordinates >= 0) {
    add_coordinates(coordinates, vertices, name);
  }
  return vertices;
}

void MeshReader::add_normals(int accessor, const Vertices& vertices, const PlacedNode& place,
                             const std::string& name) {
  const std::vector<double> values = model_.read_values(accessor, 3, name + ": NORMAL");
  if (values.size() / 3 != vertices.count) {
    model_.fail(name + ": it has " + std::to_string(vertices.count) + " positions, but " +
                std::to_string(values.size() / 3) + " normals");
  }
  const glm::dmat3 transform = normal_transform(place.world);
  scene_.normals.resize(vertices.first, glm::dvec3(0.0));
  for (std::size_t i = 0; i < vertices.count; ++i) {
    const glm::dvec3 n = transform * glm::dvec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    const double length = glm::length(n);
    const glm::dvec3 unit = n / length;
    const bool usable = std::isfinite(unit.x) && std::isfinite(unit.y) && std::isfinite(unit.z) &&
                        std::abs(glm::length(unit) - 1.0) < 1e-6;
    scene_.normals.push_back(usable ? unit : glm::dvec3(0.0));
  }
}

void MeshReader::add_coordinates(int accessor, const Vertices& vertices, const std::string& name) {
  const std::vector<double> values = model_.read_values(accessor, 2, name + ": TEXCOORD");
  if (values.size() / 2 != vertices.count) {
    model_.fail(name + ": it has " + std::to_string(vertices.count) + " positions, but " +
                std::to_string(values.size() / 2) + " texture coordinates");
  }
  scene_.uvs.resize(vertices.first, glm::dvec2(0.0));
  for (std::size_t i = 0; i < vertices.count; ++i) {
    const glm::dvec2 uv(values[2 * i], values[2 * i + 1]);
    scene_.uvs.push_back(std::isfinite(uv.x) && std::isfinite(uv.y) ? uv : glm::dvec2(0.0));
  }
}

void MeshReader::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
  if (scene_.polygons >= model_.options().max_triangles) {
    model_.fail("the scene has more than " + std::to_string(model_.options().max_triangles) +
                " triangles, which is more than is accepted");
  }
  const auto polygon = static_cast<std::uint32_t>(scene_.polygons++);
  if (bad_vertex_[a] != 0 || bad_vertex_[b] != 0 || bad_vertex_[c] != 0) {
    ++bad_triangles_;
    return;
  }
  scene_.triangles.push_back({{a, b, c}, material, polygon});
}

}  // namespace marti::scenes::gltf
