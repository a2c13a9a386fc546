#include "scenes/gltf_kept.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "scenes/gltf_instances.h"
#include "scenes/merged_instances.h"
#include "sim/key_error.h"

namespace marti::scenes::gltf {

namespace {

InstancePlace place_of(const glm::dmat4& world) {
  InstancePlace place;
  place.linear = glm::dmat3(world);
  place.shift = glm::dvec3(world[3]);
  return place;
}

bool emits(const Model& model, const tinygltf::Primitive& primitive) {
  const std::vector<tinygltf::Material>& materials = model.data().materials;
  if (primitive.material < 0 || static_cast<std::size_t>(primitive.material) >= materials.size()) {
    return false;  // a fault that is found when the primitive is read
  }
  const tinygltf::Material& material = materials[static_cast<std::size_t>(primitive.material)];
  return material.emissiveTexture.index >= 0 ||
         std::ranges::any_of(material.emissiveFactor, [](double factor) { return factor != 0.0; });
}

bool may_be_kept(const Model& model, int mesh) {
  const std::vector<tinygltf::Mesh>& meshes = model.data().meshes;
  return static_cast<std::size_t>(mesh) < meshes.size() &&
         std::ranges::none_of(meshes[static_cast<std::size_t>(mesh)].primitives,
                              [&](const tinygltf::Primitive& primitive) {
                                return !primitive.targets.empty() || emits(model, primitive);
                              });
}

}  // namespace

KeptMeshes::KeptMeshes(const Model& model, const std::vector<SceneNode>& nodes, const Pose& pose)
    : kept_(nodes.size()) {
  const Instances wanted = model.options().instances;
  if (wanted == Instances::copied) {
    return;
  }
  if (wanted == Instances::automatic && expanded_instances(model, nodes).triangles <= many_copies) {
    return;
  }
  std::map<int, std::vector<std::size_t>> users;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const tinygltf::Node& node = model.data().nodes[static_cast<std::size_t>(nodes[i].node)];
    const int mesh = nodes[i].mesh;
    if (mesh >= 0 && node.skin < 0 && why_not_kept(place_of(pose.nodes[i].world)).empty()) {
      users[mesh].push_back(i);
    }
  }
  for (auto& [mesh, places] : users) {
    if (places.size() > 1 && may_be_kept(model, mesh)) {
      for (const std::size_t place : places) {
        kept_[place] = true;
      }
      places_.emplace(mesh, std::move(places));
    }
  }
}

std::vector<SceneNode> KeptMeshes::distinct(const std::vector<SceneNode>& nodes) const {
  std::vector<bool> wanted(nodes.size(), true);
  for (const auto& [mesh, places] : places_) {
    for (const std::size_t place : places) {
      wanted[place] = place == places.front();
    }
  }
  std::vector<SceneNode> chosen;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (wanted[i]) {
      chosen.push_back(nodes[i]);
    }
  }
  return chosen;
}

void KeptMeshes::add(MeshReader& reader, Pose& pose, Scene& scene) {
  if (places_.empty()) {
    return;
  }
  begin_instances(scene);
  for (const auto& [mesh, places] : places_) {
    const auto first = static_cast<std::uint32_t>(scene.triangles.size());
    const glm::dmat4 world = std::exchange(pose.nodes[places.front()].world, glm::dmat4(1.0));
    reader.add(places.front(), pose);
    pose.nodes[places.front()].world = world;
    const auto count = static_cast<std::uint32_t>(scene.triangles.size()) - first;
    if (count == 0) {
      continue;
    }
    for (const std::size_t place : places) {
      InstancePlace& instance = scene.instances.emplace_back(place_of(pose.nodes[place].world));
      instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
      order_.push_back(place);
    }
    scene.meshes.push_back({first, count});
  }
  number_instances(scene);
}

void KeptMeshes::move(const Pose& pose, Scene& scene) const {
  if (order_.empty()) {
    return;
  }
  const std::size_t copied = scene.instances.size() - order_.size();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    InstancePlace place = place_of(pose.nodes[order_[i]].world);
    if (const std::string why = why_not_kept(place); !why.empty()) {
      throw sim::KeyError("structure.instances", "node " + std::to_string(pose.nodes[order_[i]].node) +
                                                     " cannot be kept in this pose: " + why +
                                                     "; set \"copied\"");
    }
    place.mesh = scene.instances[copied + i].mesh;
    scene.instances[copied + i] = place;
  }
  number_instances(scene);
}

}  // namespace marti::scenes::gltf
