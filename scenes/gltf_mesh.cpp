#include "scenes/gltf_mesh.h"

#include <array>
#include <cmath>

#include "scenes/gltf_animation.h"
#include "scenes/gltf_exact.h"
#include "scenes/gltf_extensions.h"
#include "sim/shown.h"

namespace marti::scenes::gltf {

void MeshReader::add(std::size_t place, Pose& pose) {
  const int index = pose.nodes[place].node;
  const tinygltf::Node& node = model_.data().nodes[static_cast<std::size_t>(index)];
  const std::string user_name = "node " + std::to_string(index);
  const tinygltf::Mesh& mesh = model_.at(model_.data().meshes, node.mesh, "mesh", user_name);
  // Counted, because primitives without triangles cost time too: many nodes times many points.
  visits_ += mesh.primitives.size();
  if (visits_ > model_.options().max_triangles) {
    model_.fail("the scene has more than " + std::to_string(model_.options().max_triangles) +
                " primitives, which is more than is accepted");
  }
  User user;
  user.place = place;
  auto targets = targets_.find(node.mesh);
  if (targets == targets_.end()) {
    targets = targets_.emplace(node.mesh, morph_target_count(model_, node.mesh)).first;
    morph_targets_ += targets->second;
  }
  user.weights = default_weights(model_, index, targets->second);
  if (node.skin >= 0) {
    user.skin = static_cast<int>(skins_.use(node.skin, index));
    while (pose.joints.size() < skins_.size()) {
      pose.joints.push_back(skins_.matrices(pose.joints.size(), pose.nodes));
    }
  }
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = mesh.primitives[i];
    if (primitive.mode >= TINYGLTF_MODE_POINTS && primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      left_out_.features["primitives of points or lines"] += 1;
      continue;
    }
    const std::string name = "mesh " + std::to_string(node.mesh) + ", primitive " + std::to_string(i);
    add_primitive(primitive, pose, name, user);
  }
}

void MeshReader::add_primitive(const tinygltf::Primitive& primitive, const Pose& pose,
                               const std::string& name, User& user) {
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    model_.fail(name + ": there is no primitive mode " + std::to_string(primitive.mode));
  }
  if (attribute(primitive.attributes, "POSITION") < 0) {
    left_out_.features["primitives without positions"] += 1;
    return;
  }
  if (const std::string extension = compression_of_primitive(model_.data(), primitive); !extension.empty()) {
    model_.fail(name + " is compressed by the extension " + extension + ", " + why_unsupported(extension));
  }
  left_out_.features["vertex colours"] += attribute(primitive.attributes, "COLOR_0") >= 0 ? 1U : 0U;
  const Materials::Use use = materials_.use(primitive.material);
  const CutOut& cut_out = scene_.materials[use.material].cut_out;
  if (cut_out.everywhere()) {
    left_out_.features["primitives that are cut out as a whole"] += 1;
    return;
  }
  Coordinates coordinates;
  if (use.texture_coordinates >= 0) {
    const std::string semantic = "TEXCOORD_" + std::to_string(use.texture_coordinates);
    coordinates = {attribute(primitive.attributes, semantic),
                   exact_view(model_, primitive.extras, "TEXCOORD_0"), use.transform};
    left_out_.features["textures on primitives without the texture coordinates for them"] +=
        coordinates.accessor < 0 ? 1U : 0U;
    if (coordinates.accessor < 0 && cut_out.asks()) {
      left_out_.replace("texture coordinates of cut-outs that are not given, by (0, 0)",
                        sim::shown(model_.path().string()) + ": " + name + ": its material is cut out by a " +
                            "texture, so it needs " + semantic);
    }
    for (const auto& target : primitive.targets) {
      left_out_.features["displacements of texture coordinates"] += target.contains(semantic) ? 1U : 0U;
    }
  }
  const std::shared_ptr<const VertexSource> source = vertices_.read(primitive, user.skin >= 0, name);
  if (user.skin >= 0 && source->highest_joint >= skins_.joints(static_cast<std::size_t>(user.skin))) {
    model_.fail(name + ": joint " + std::to_string(source->highest_joint) +
                " is out of range; the skin has " +
                std::to_string(skins_.joints(static_cast<std::size_t>(user.skin))));
  }
  auto known = user.shared.find({source.get(), coordinates});
  if (known == user.shared.end()) {
    known = user.shared
                .emplace(std::pair(source.get(), coordinates),
                         add_vertices(source, coordinates, pose, name, user))
                .first;
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
  // The transform of a skinned mesh's node is ignored (section 3.7.3.2), including its mirroring.
  const bool mirrored = user.skin < 0 && is_mirrored(pose.nodes[user.place].world);
  const auto first = static_cast<std::uint32_t>(scene_.triangles.size());
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
  if (user.skin < 0) {
    ranges_.push_back(
        {first, static_cast<std::uint32_t>(scene_.triangles.size()) - first, user.place, mirrored});
  }
}

MeshReader::Vertices MeshReader::add_vertices(std::shared_ptr<const VertexSource> source,
                                              Coordinates coordinates, const Pose& pose,
                                              const std::string& name, const User& user) {
  const std::size_t count = source->positions.size();
  if (scene_.positions.size() + count > model_.options().max_triangles) {
    model_.fail("the scene has more than " + std::to_string(model_.options().max_triangles) +
                " vertices, which is more than is accepted");
  }
  vertices_.charge_instance(*source);
  const Vertices vertices{static_cast<std::uint32_t>(scene_.positions.size()),
                          static_cast<std::uint32_t>(count)};
  scene_.positions.resize(vertices.first + count);
  bad_vertex_.resize(vertices.first + count);
  if (!source->normals.empty()) {
    scene_.normals.resize(vertices.first + count, glm::dvec3(0.0));
  }
  instances_.push_back({std::move(source), vertices.first, user.place, user.skin, user.weights});
  pose_vertices(instances_.back(), pose, scene_, bad_vertex_);
  if (coordinates.accessor >= 0) {
    add_coordinates(coordinates, vertices, name);
  }
  return vertices;
}

void MeshReader::add_coordinates(Coordinates coordinates, const Vertices& vertices, const std::string& name) {
  std::vector<double> values = model_.read_values(coordinates.accessor, 2, name + ": TEXCOORD");
  restore_values(model_, coordinates.exact, name + ": TEXCOORD", values);
  if (values.size() / 2 != vertices.count) {
    model_.fail(name + ": it has " + std::to_string(vertices.count) + " positions, but " +
                std::to_string(values.size() / 2) + " texture coordinates");
  }
  scene_.uvs.resize(vertices.first, glm::dvec2(0.0));
  for (std::size_t i = 0; i < vertices.count; ++i) {
    const glm::dvec2 given(values[2 * i], values[2 * i + 1]);
    const glm::dvec2 uv = coordinates.transform == TextureTransform() ? given : coordinates.transform(given);
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
