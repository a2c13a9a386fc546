#include "scenes/gltf_skin.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>

namespace marti::scenes::gltf {

std::size_t Skins::use(int skin, int node) {
  const auto known = used_.find(skin);
  if (known != used_.end()) {
    return known->second;
  }
  skins_.push_back(read(skin, node));
  used_[skin] = skins_.size() - 1;
  return skins_.size() - 1;
}

Skins::Skin Skins::read(int skin, int node) {
  const tinygltf::Skin& source = model_.at(model_.data().skins, skin, "skin", "node " + std::to_string(node));
  const std::string name = "skin " + std::to_string(skin);
  if (source.joints.empty()) {
    model_.fail(name + " has no joints");
  }
  if (place_of_node_.empty()) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      place_of_node_.emplace(nodes_[i].node, i);  // of which the places of its mesh follow
    }
  }
  Skin read;
  for (const int joint : source.joints) {
    static_cast<void>(model_.at(model_.data().nodes, joint, "node", name));
    const auto place = place_of_node_.find(joint);
    if (place == place_of_node_.end()) {
      model_.fail(name + ": its joint, node " + std::to_string(joint) + ", is not in the scene");
    }
    read.joints.push_back(place->second);
  }
  if (source.inverseBindMatrices < 0) {
    read.inverse_bind.assign(read.joints.size(), glm::dmat4(1.0));
    return read;
  }
  const std::vector<double> values = model_.read_matrices(source.inverseBindMatrices, read.joints.size(),
                                                          name + ": its inverse bind matrices");
  for (std::size_t i = 0; i < read.joints.size(); ++i) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(16 * i);
    const glm::dmat4 m = glm::make_mat4(&values[16 * i]);
    if (!std::all_of(first, first + 16, [](double value) { return std::isfinite(value); }) ||
        m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0) {
      model_.fail(name + ": inverse bind matrix " + std::to_string(i) +
                  " must be finite, with a last row of 0 0 0 1");
    }
    read.inverse_bind.push_back(m);
  }
  return read;
}

std::vector<glm::dmat4> Skins::matrices(std::size_t place, const std::vector<PlacedNode>& placed) const {
  const Skin& skin = skins_[place];
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    matrices.push_back(placed[skin.joints[i]].world * skin.inverse_bind[i]);
  }
  return matrices;
}

}  // namespace marti::scenes::gltf
