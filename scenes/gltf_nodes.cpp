#include "scenes/gltf_nodes.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "scenes/gltf_instancing.h"
#include "sim/nearest.h"
#include "sim/parse_number.h"
#include "sim/shown.h"

namespace marti::scenes::gltf {

namespace {

std::string name_of_node(int node) { return "node " + std::to_string(node); }

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool is_finite(const glm::dmat4& m) {
  const double* values = glm::value_ptr(m);
  return std::all_of(values, values + 16, [](double v) { return std::isfinite(v); });
}

/// Three or four numbers of a node, from the animation if it changes them, else from the file.
template <typename Vector>
std::vector<double> changed(const std::optional<Vector>& change, const std::vector<double>& given) {
  if (!change) {
    return given;
  }
  std::vector<double> numbers;
  for (int i = 0; i < Vector::length(); ++i) {
    numbers.push_back((*change)[i]);
  }
  return numbers;
}

glm::dmat4 local_transform(const Model& model, int index, const NodeChange& change) {
  const tinygltf::Node& node = model.data().nodes[static_cast<std::size_t>(index)];
  const auto check = [&](const std::vector<double>& values, std::size_t size, const char* what) {
    if ((!values.empty() && values.size() != size) || !all_finite(values)) {
      model.fail(name_of_node(index) + ": its " + what + " must be " + std::to_string(size) +
                 " finite numbers");
    }
  };
  check(node.matrix, 16, "matrix");
  if (!node.matrix.empty()) {
    const glm::dmat4 m = glm::make_mat4(node.matrix.data());
    if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0) {
      model.fail(name_of_node(index) + ": the last row of its matrix must be 0 0 0 1");
    }
    return m;
  }
  const std::vector<double> translation = changed(change.translation, node.translation);
  const std::vector<double> rotation = changed(change.rotation, node.rotation);
  const std::vector<double> scale = changed(change.scale, node.scale);
  check(translation, 3, "translation");
  check(rotation, 4, "rotation");
  check(scale, 3, "scale");
  Transform parts;
  if (!translation.empty()) {
    parts.translation = glm::make_vec3(translation.data());
  }
  if (!rotation.empty()) {
    parts.rotation = glm::dquat(rotation[3], rotation[0], rotation[1], rotation[2]);
  }
  if (!scale.empty()) {
    parts.scale = glm::make_vec3(scale.data());
  }
  const std::optional<glm::dmat4> matrix = parts.matrix();
  if (!matrix) {
    model.fail(name_of_node(index) + ": its rotation is no unit quaternion");
  }
  return *matrix;
}

struct Family {
  std::vector<int> parents;  // of each node, -1 for none
  std::vector<int> order;    // all nodes, each behind its parent
};

/// Throws for a node with two parents and for cycles.
Family find_parents(const Model& model) {
  const std::vector<tinygltf::Node>& nodes = model.data().nodes;
  Family family{std::vector<int>(nodes.size(), -1), {}};
  std::vector<int>& parents = family.parents;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const int parent = static_cast<int>(i);
    for (const int child : nodes[i].children) {
      static_cast<void>(model.at(nodes, child, "node", name_of_node(parent)));
      int& known = parents[static_cast<std::size_t>(child)];
      if (known >= 0) {
        model.fail(name_of_node(child) + " is a child of two nodes, or twice of one: " +
                   std::to_string(known) + " and " + std::to_string(parent));
      }
      known = parent;
    }
  }
  // As each node has at most one parent, the nodes not reached from the roots are those in and below cycles.
  std::vector<int>& reached = family.order;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (parents[i] < 0) {
      reached.push_back(static_cast<int>(i));
    }
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const std::vector<int>& children = nodes[static_cast<std::size_t>(reached[i])].children;
    reached.insert(reached.end(), children.begin(), children.end());
  }
  if (reached.size() != nodes.size()) {
    model.fail("its nodes are recursive: " + std::to_string(nodes.size() - reached.size()) +
               " of them are their own ancestors or below such a node");
  }
  return family;
}

/// The roots that a scene lists, each once, and not those below another.
std::vector<int> distinct_roots(const Model& model, const Family& family, int scene, LeftOut& left_out) {
  const std::vector<int>& listed = model.data().scenes[static_cast<std::size_t>(scene)].nodes;
  std::vector<char> is_listed(family.parents.size(), 0);
  for (const int root : listed) {
    static_cast<void>(model.at(model.data().nodes, root, "node", "scene " + std::to_string(scene)));
    is_listed[static_cast<std::size_t>(root)] = 1;
  }
  std::vector<char> is_below(family.parents.size(), 0);
  for (const int node : family.order) {
    const int parent = family.parents[static_cast<std::size_t>(node)];
    if (parent >= 0) {
      const auto above = static_cast<std::size_t>(parent);
      is_below[static_cast<std::size_t>(node)] = static_cast<char>(is_listed[above] | is_below[above]);
    }
  }
  std::vector<int> roots;
  std::vector<char> taken(family.parents.size(), 0);
  for (const int root : listed) {
    const auto at = static_cast<std::size_t>(root);
    const bool again = taken[at] != 0;
    if (again || family.parents[at] >= 0) {
      left_out.replace("nodes that a scene lists twice or although they are children, by one in its place",
                       sim::shown(model.path().string()) + ": " + name_of_node(root) +
                           " is listed in scene " + std::to_string(scene) +
                           " twice, or although it is a child of another node");
    }
    if (!again && is_below[at] == 0) {
      roots.push_back(root);
    }
    taken[at] = 1;
  }
  return roots;
}

std::vector<int> roots_of_scene(const Model& model, const Family& family, LeftOut& left_out) {
  const tinygltf::Model& data = model.data();
  if (data.scenes.empty()) {
    std::vector<int> roots;
    if (!model.options().scene.empty()) {
      model.fail_choice("scene", "scene '" + sim::shown(model.options().scene) +
                                     "' is asked for, but the file has no scenes");
    }
    for (std::size_t i = 0; i < family.parents.size(); ++i) {
      if (family.parents[i] < 0) {
        roots.push_back(static_cast<int>(i));
      }
    }
    return roots;
  }
  int index = data.defaultScene == -1 ? 0 : data.defaultScene;
  if (!model.options().scene.empty()) {
    std::vector<std::string> names;
    for (const tinygltf::Scene& scene : data.scenes) {
      names.push_back(scene.name);
    }
    index = chosen_index(model, model.options().scene, "scene", names);
  }
  static_cast<void>(model.at(data.scenes, index, "scene", "the file"));
  return distinct_roots(model, family, index, left_out);
}

}  // namespace

std::optional<glm::dmat4> Transform::matrix() const {
  const double length = glm::length(rotation);
  if (!is_usable_quaternion(length)) {
    return std::nullopt;
  }
  glm::dmat4 m = glm::mat4_cast(rotation / length);
  for (int axis = 0; axis < 3; ++axis) {
    m[axis] *= scale[axis];
    m[3][axis] = translation[axis];
  }
  return m;
}

std::vector<SceneNode> nodes_of_scene(const Model& model, LeftOut& left_out) {
  const std::vector<int> roots = roots_of_scene(model, find_parents(model), left_out);
  std::vector<SceneNode> nodes;
  // An explicit stack, because the file decides the depth of the hierarchy. Pushed in reverse to keep order.
  std::vector<SceneNode> open;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
    open.push_back({*root});
  }
  while (!open.empty()) {
    const SceneNode here = open.back();
    open.pop_back();
    const int place = static_cast<int>(nodes.size());
    const tinygltf::Node& node = model.data().nodes[static_cast<std::size_t>(here.node)];
    nodes.push_back(here);
    if (is_instanced(node)) {
      for (const glm::dmat4& transform : instance_transforms(model, here.node)) {
        nodes.push_back({here.node, place, node.mesh, transform});
      }
    } else {
      nodes.back().mesh = node.mesh;
    }
    const std::vector<int>& children = node.children;
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      open.push_back({*child, place});
    }
  }
  return nodes;
}

std::vector<PlacedNode> place_nodes(const Model& model, const std::vector<SceneNode>& nodes,
                                    const NodeChanges& changes) {
  static const NodeChange none;
  std::vector<PlacedNode> placed;
  placed.reserve(nodes.size());
  for (const SceneNode& node : nodes) {
    const auto change = changes.find(node.node);
    const glm::dmat4 local =
        node.place ? *node.place
                   : local_transform(model, node.node, change == changes.end() ? none : change->second);
    const glm::dmat4 above =
        node.parent < 0 ? glm::dmat4(1.0) : placed[static_cast<std::size_t>(node.parent)].world;
    placed.push_back({node.node, !node.place, above * local});
    if (!is_finite(placed.back().world)) {
      model.fail(name_of_node(node.node) + ": its transform to world space is not finite");
    }
  }
  return placed;
}

int chosen_index(const Model& model, const std::string& choice, const char* kind,
                 const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == choice) {
      return static_cast<int>(i);
    }
  }
  const std::optional<int> index = sim::parse_number<int>(choice);
  if (!index || *index < 0 || static_cast<std::size_t>(*index) >= names.size()) {
    model.fail_choice(kind, "it has no " + std::string(kind) + " '" + sim::shown(choice) + "'" +
                                sim::did_you_mean(choice, names) + "; there are " +
                                std::to_string(names.size()) + ", to be chosen by name or by number from 0");
  }
  return *index;
}

}  // namespace marti::scenes::gltf
