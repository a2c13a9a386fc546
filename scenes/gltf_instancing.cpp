#include "scenes/gltf_instancing.h"

#include <optional>
#include <string>

#include <glm/gtc/quaternion.hpp>

#include "scenes/gltf_material.h"
#include "scenes/gltf_nodes.h"

namespace marti::scenes::gltf {

namespace {

constexpr const char* gpu_instancing = "EXT_mesh_gpu_instancing";

const tinygltf::Value& attributes_of(const tinygltf::Node& node) {
  static const tinygltf::Value none;
  const tinygltf::Value& given = node.extensions.at(gpu_instancing);
  return given.IsObject() ? given.Get("attributes") : none;
}

/// The attributes of a node's extension.
class Attributes {
 public:
  Attributes(const Model& model, int node)
      : model_(model),
        name_("node " + std::to_string(node) + ": its " + gpu_instancing),
        list_(attributes_of(model.data().nodes[static_cast<std::size_t>(node)])) {
    if (!list_.IsObject() || list_.Keys().empty()) {
      fail(" has no attributes");
    }
    for (const std::string& attribute : list_.Keys()) {
      const std::size_t count = accessor(attribute).count;
      if (count_.value_or(count) != count) {
        fail(" has attributes of " + std::to_string(*count_) + " and of " + std::to_string(count) +
             " places");
      }
      count_ = count;
    }
    if (*count_ > model.options().max_triangles) {
      fail(" has more than " + std::to_string(model.options().max_triangles) + " places");
    }
    model.take_memory(*count_ * (sizeof(SceneNode) + 2 * sizeof(PlacedNode)),
                      "the places of its meshes take");
  }

  [[nodiscard]] std::size_t count() const { return *count_; }

  /// Of all places; empty without the attribute.
  [[nodiscard]] std::vector<double> read(const char* attribute, int components) const {
    if (!list_.Has(attribute)) {
      return {};
    }
    return model_.read_values(*index_in(list_, attribute), components, name_ + ", " + attribute);
  }

  [[noreturn]] void fail(const std::string& what) const { model_.fail(name_ + what); }

 private:
  const tinygltf::Accessor& accessor(const std::string& attribute) const {
    return model_.at(model_.data().accessors, index_in(list_, attribute.c_str()).value_or(-1), "accessor",
                     name_ + ", " + attribute);
  }

  const Model& model_;
  std::string name_;
  const tinygltf::Value& list_;
  std::optional<std::size_t> count_;
};

}  // namespace

bool is_instanced(const tinygltf::Node& node) {
  return node.mesh >= 0 && node.extensions.contains(gpu_instancing);
}

std::vector<glm::dmat4> instance_transforms(const Model& model, int node) {
  const Attributes attributes(model, node);
  if (model.data().nodes[static_cast<std::size_t>(node)].skin >= 0) {
    attributes.fail(" gives places to a mesh with a skin, which stands where its joints are");
  }
  const std::vector<double> translations = attributes.read("TRANSLATION", 3);
  const std::vector<double> rotations = attributes.read("ROTATION", 4);
  const std::vector<double> scales = attributes.read("SCALE", 3);
  std::vector<glm::dmat4> all;
  all.reserve(attributes.count());
  for (std::size_t i = 0; i < attributes.count(); ++i) {
    Transform transform;
    if (!translations.empty()) {
      transform.translation = {translations[3 * i], translations[3 * i + 1], translations[3 * i + 2]};
    }
    if (!rotations.empty()) {
      const double* const q = &rotations[4 * i];
      transform.rotation = glm::dquat(q[3], q[0], q[1], q[2]);
    }
    if (!scales.empty()) {
      transform.scale = {scales[3 * i], scales[3 * i + 1], scales[3 * i + 2]};
    }
    const std::optional<glm::dmat4> matrix = transform.matrix();
    if (!matrix) {
      attributes.fail(": the rotation of place " + std::to_string(i) + " is no unit quaternion");
    }
    all.push_back(*matrix);
  }
  return all;
}

}  // namespace marti::scenes::gltf
