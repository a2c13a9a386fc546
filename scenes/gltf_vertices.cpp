#include "scenes/gltf_vertices.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "scenes/gltf_exact.h"
#include "scenes/vertex_values.h"

namespace marti::scenes::gltf {

namespace {

/// The sum of a vertex's vector and its weighted displacements. A displacement with weight 0 is left out even
/// if it is not finite; without weights all are left out.
glm::dvec3 morphed(glm::dvec3 vector, const VertexSource& source, const std::vector<double>* weights,
                   std::vector<glm::dvec3> MorphTarget::*kind, std::size_t vertex) {
  for (std::size_t i = 0; weights != nullptr && i < source.targets.size(); ++i) {
    const std::vector<glm::dvec3>& displacements = source.targets[i].*kind;
    if ((*weights)[i] != 0.0 && !displacements.empty()) {
      vector += (*weights)[i] * displacements[vertex];
    }
  }
  return vector;
}

/// The weighted sum of the matrices of a vertex's joints.
glm::dmat4 blended(const VertexSource& source, const std::vector<glm::dmat4>& joints, std::size_t vertex) {
  glm::dmat4 sum(0.0);
  bool first = true;
  for (std::size_t i = vertex * source.influences; i < (vertex + 1) * source.influences; ++i) {
    if (source.weights[i] != 0.0) {
      const glm::dmat4 part = joints[source.joints[i]] * source.weights[i];
      sum = first ? part : sum + part;
      first = false;
    }
  }
  return sum;
}

std::string set_name(const char* semantic, std::size_t set) {
  return std::string(semantic) + "_" + std::to_string(set);
}

/// The number of sets of joints and weights that a primitive has.
std::size_t influence_sets(const Model& model, const tinygltf::Primitive& primitive,
                           const std::string& name) {
  std::size_t joints = 0;
  std::size_t weights = 0;
  for (const auto& [semantic, accessor] : primitive.attributes) {
    joints += semantic.starts_with("JOINTS_") ? 1U : 0U;
    weights += semantic.starts_with("WEIGHTS_") ? 1U : 0U;
  }
  if (joints == 0 || joints != weights) {
    model.fail(name + ": its node has a skin, so it needs as many JOINTS_n as WEIGHTS_n; it has " +
               std::to_string(joints) + " and " + std::to_string(weights));
  }
  return joints;
}

}  // namespace

int attribute(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

bool is_mirrored(const glm::dmat4& world) { return is_mirroring(glm::dmat3(world)); }

std::shared_ptr<const VertexSource> VertexReader::read(const tinygltf::Primitive& primitive, bool skinned,
                                                       const std::string& name) {
  constexpr int next_section = -2;
  charge(primitive.targets.size() + (skinned ? primitive.attributes.size() : 0));
  Key key = {attribute(primitive.attributes, "POSITION"), attribute(primitive.attributes, "NORMAL")};
  for (const auto& target : primitive.targets) {
    key.push_back(attribute(target, "POSITION"));
    key.push_back(attribute(target, "NORMAL"));
  }
  key.push_back(next_section);
  const int exact_positions = exact_view(model_, primitive.extras, "POSITION");
  const int exact_normals = exact_view(model_, primitive.extras, "NORMAL");
  key.push_back(exact_positions);
  key.push_back(exact_normals);
  const std::size_t sets = skinned ? influence_sets(model_, primitive, name) : 0;
  for (std::size_t set = 0; set < sets; ++set) {
    for (const char* semantic : {"JOINTS", "WEIGHTS"}) {
      key.push_back(attribute(primitive.attributes, set_name(semantic, set)));
      if (key.back() < 0) {
        model_.fail(name + " has no " + set_name(semantic, set) + ", though it has " + std::to_string(sets) +
                    " sets");
      }
    }
  }
  const auto known = known_.find(key);
  if (known != known_.end()) {
    return known->second;
  }

  auto source = std::make_shared<VertexSource>();
  source->positions = read_vectors(key[0], exact_positions, name + ": POSITION");
  const std::size_t count = source->positions.size();
  if (key[1] >= 0) {
    source->normals = read_counted(key[1], exact_normals, count, name + ": NORMAL", "normals");
  }
  charge(count * (primitive.targets.size() + 4 * sets));
  read_targets(primitive, *source, name);
  source->influences = 4 * sets;
  read_influences(primitive, *source, name);
  known_[key] = source;
  return source;
}

void VertexReader::charge(std::uint64_t work) {
  work_ += work;
  const std::uint64_t most = 4 * model_.options().max_triangles;
  if (work_ > most) {
    model_.fail("the scene has more than " + std::to_string(most) +
                " displacements and joints of vertices, which is more than is accepted");
  }
}

std::vector<glm::dvec3> VertexReader::read_vectors(int accessor, int exact, const std::string& name) const {
  std::vector<double> values = model_.read_values(accessor, 3, name);
  restore_values(model_, exact, name, values);
  std::vector<glm::dvec3> vectors;
  vectors.reserve(values.size() / 3);
  for (std::size_t i = 0; i < values.size(); i += 3) {
    vectors.emplace_back(values[i], values[i + 1], values[i + 2]);
  }
  return vectors;
}

std::vector<glm::dvec3> VertexReader::read_counted(int accessor, int exact, std::size_t count,
                                                   const std::string& name, const char* what) const {
  std::vector<glm::dvec3> vectors = read_vectors(accessor, exact, name);
  if (vectors.size() != count) {
    model_.fail(name + ": there are " + std::to_string(count) + " positions, but " +
                std::to_string(vectors.size()) + " " + what);
  }
  return vectors;
}

void VertexReader::read_targets(const tinygltf::Primitive& primitive, VertexSource& source,
                                const std::string& name) const {
  for (std::size_t i = 0; i < primitive.targets.size(); ++i) {
    const std::map<std::string, int>& from = primitive.targets[i];
    const std::string user = name + ", morph target " + std::to_string(i);
    MorphTarget& target = source.targets.emplace_back();
    if (from.contains("POSITION")) {
      target.positions = read_counted(from.at("POSITION"), -1, source.positions.size(), user + ": POSITION",
                                      "displacements");
    }
    // Without normals of the mesh, triangles use their own, and displacements of normals are ignored.
    if (from.contains("NORMAL") && !source.normals.empty()) {
      target.normals =
          read_counted(from.at("NORMAL"), -1, source.positions.size(), user + ": NORMAL", "displacements");
    }
  }
}

void VertexReader::read_influences(const tinygltf::Primitive& primitive, VertexSource& source,
                                   const std::string& name) const {
  const std::size_t count = source.positions.size();
  source.joints.resize(count * source.influences);
  source.weights.resize(count * source.influences);
  for (std::size_t set = 0; set < source.influences / 4; ++set) {
    for (const bool is_joint : {true, false}) {
      const std::string semantic = set_name(is_joint ? "JOINTS" : "WEIGHTS", set);
      const int index = primitive.attributes.at(semantic);
      const std::string user = name + ": " + semantic;
      const std::vector<double> values = model_.read_values(index, 4, user);
      const tinygltf::Accessor& accessor = model_.data().accessors[static_cast<std::size_t>(index)];
      const bool is_unsigned = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                               accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
      if (is_joint && (!is_unsigned || accessor.normalized)) {
        model_.fail(user + " must be unsigned bytes or shorts, not normalised");
      }
      if (!is_joint && !(is_unsigned && accessor.normalized) &&
          accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
        model_.fail(user + " must be floats, or normalised unsigned bytes or shorts");
      }
      if (values.size() != 4 * count) {
        model_.fail(user + ": there are " + std::to_string(count) + " positions, but " +
                    std::to_string(values.size() / 4) + " of these");
      }
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t at = (i / 4) * source.influences + 4 * set + i % 4;
        if (is_joint) {
          source.joints[at] = static_cast<std::uint32_t>(values[i]);
          source.highest_joint = std::max(source.highest_joint, source.joints[at]);
        } else if (std::isfinite(values[i]) && values[i] >= 0.0) {
          source.weights[at] = values[i];
        } else {
          model_.fail(user + ": a weight of vertex " + std::to_string(i / 4) + " is negative or not finite");
        }
      }
    }
  }
  for (std::size_t i = 0; i < source.weights.size(); i += source.influences) {
    double sum = 0.0;
    for (std::size_t k = 0; k < source.influences; ++k) {
      sum += source.weights[i + k];
    }
    if (!(sum > 0.0)) {
      model_.fail(name + ": the weights of vertex " + std::to_string(i / source.influences) +
                  " add up to 0; no joint moves it");
    }
    for (std::size_t k = 0; k < source.influences; ++k) {
      source.weights[i + k] /= sum;
    }
  }
}

void pose_vertices(const VertexInstance& instance, const Pose& pose, Scene& scene, std::vector<char>& bad) {
  const VertexSource& source = *instance.source;
  const PlacedNode& node = pose.nodes[instance.place];
  const auto change = pose.changes.find(node.node);
  const bool changed = change != pose.changes.end() && !change->second.weights.empty();
  const std::vector<double>* const weights = changed ? &change->second.weights : instance.weights;
  const bool skinned = instance.skin >= 0;
  const bool with_normals = !source.normals.empty();
  glm::dmat4 world = node.world;
  glm::dmat3 turn = with_normals ? normal_transform(glm::dmat3(world)) : glm::dmat3(1.0);
  for (std::size_t i = 0; i < source.positions.size(); ++i) {
    if (skinned) {
      world = blended(source, pose.joints[static_cast<std::size_t>(instance.skin)], i);
      turn = with_normals ? normal_transform(glm::dmat3(world)) : turn;
    }
    const std::size_t at = instance.first + i;
    const glm::dvec3 bound = morphed(source.positions[i], source, weights, &MorphTarget::positions, i);
    const glm::dvec3 p(world * glm::dvec4(bound, 1.0));
    const bool usable = is_usable(p);
    bad[at] = usable ? 0 : 1;
    scene.positions[at] = usable ? p : glm::dvec3(0.0);
    if (with_normals) {
      scene.normals[at] =
          unit_or_zero(turn * morphed(source.normals[i], source, weights, &MorphTarget::normals, i));
    }
  }
}

}  // namespace marti::scenes::gltf
