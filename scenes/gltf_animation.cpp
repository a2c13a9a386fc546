#include "scenes/gltf_animation.h"
#include "sim/shown.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

namespace marti::scenes::gltf {

namespace {

Interpolation interpolation_of(const Model& model, const std::string& text, const std::string& name) {
  if (text == "STEP") {
    return Interpolation::step;
  }
  if (text == "LINEAR") {
    return Interpolation::linear;
  }
  if (text != "CUBICSPLINE") {
    model.fail(name + ": its interpolation is '" + sim::shown(text) +
               "'; known are STEP, LINEAR and CUBICSPLINE");
  }
  return Interpolation::cubic_spline;
}

void check_weights(const Model& model, const std::vector<double>& weights, std::size_t count,
                   const std::string& user) {
  const auto finite = [](double weight) { return std::isfinite(weight); };
  if (weights.size() != count || !std::all_of(weights.begin(), weights.end(), finite)) {
    model.fail(user + ": its weights must be " + std::to_string(count) +
               " finite numbers, one for each morph target");
  }
}

/// Reads the data of samplers, and keeps their sum within the file's limits.
class TrackReader {
 public:
  TrackReader(const Model& model, std::string animation) : model_(model), animation_(std::move(animation)) {}

  KeyFrames read(const tinygltf::AnimationSampler& sampler, const std::string& name, std::size_t width,
                 bool only_floats, bool is_rotation) {
    KeyFrames frames;
    frames.interpolation = interpolation_of(model_, sampler.interpolation, name);
    frames.width = width;
    charge(sampler.input, name + ": its input");
    charge(sampler.output, name + ": its output");
    if (accessor(sampler.input, name + ": its input").componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
      model_.fail(name + ": its input must be floats, in seconds");
    }
    frames.times = model_.read_values(sampler.input, 1, name + ": its input");
    check_times(frames.times, name);
    check_output_type(sampler.output, only_floats, name);
    const bool scalars = !is_rotation && !only_floats;  // weights are stored as scalars
    frames.values =
        model_.read_values(sampler.output, scalars ? 1 : static_cast<int>(width), name + ": its output");
    const bool spline = frames.interpolation == Interpolation::cubic_spline;
    if (spline && frames.times.size() < 2) {
      model_.fail(name + ": a cubic spline needs two key frames at least");
    }
    const std::size_t expected = frames.times.size() * width * (spline ? 3 : 1);
    if (frames.values.size() != expected) {
      model_.fail(name + ": its output has " + std::to_string(frames.values.size()) + " numbers; " +
                  std::to_string(expected) + " are needed for " + std::to_string(frames.times.size()) +
                  " key frames");
    }
    check_values(frames, is_rotation, name);
    return frames;
  }

 private:
  [[nodiscard]] const tinygltf::Accessor& accessor(int index, const std::string& user) const {
    return model_.at(model_.data().accessors, index, "accessor", user);
  }

  /// Counts elements for each sampler: many samplers may share one large accessor in a small file.
  void charge(int index, const std::string& user) {
    const std::uint64_t count = accessor(index, user).count;
    read_ += count;
    if (read_ > model_.options().max_triangles) {
      model_.fail(animation_ + " has more than " + std::to_string(model_.options().max_triangles) +
                  " key frames and values, which is more than is accepted");
    }
    constexpr std::uint64_t most_numbers = 4;  // of an element: those of a quaternion
    model_.take_memory(count * most_numbers * sizeof(double), "its key frames take");
  }

  void check_times(const std::vector<double>& times, const std::string& name) const {
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (!(std::isfinite(times[i]) && times[i] >= 0.0)) {
        model_.fail(name + ": the time of key frame " + std::to_string(i) + " is not finite or below 0");
      }
      if (i > 0 && times[i] <= times[i - 1]) {
        model_.fail(name + ": its times must increase, but that of key frame " + std::to_string(i) +
                    " does not");
      }
    }
  }

  void check_output_type(int index, bool only_floats, const std::string& name) const {
    const tinygltf::Accessor& output = accessor(index, name + ": its output");
    if (output.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT && (only_floats || !output.normalized)) {
      model_.fail(name + ": its output must be floats" + (only_floats ? "" : " or normalised integers"));
    }
  }

  void check_values(const KeyFrames& frames, bool is_rotation, const std::string& name) const {
    const bool finite = std::all_of(frames.values.begin(), frames.values.end(),
                                    [](double value) { return std::isfinite(value); });
    if (!finite) {
      model_.fail(name + ": its output has a value that is not finite");
    }
    for (std::size_t i = 0; is_rotation && i < frames.times.size(); ++i) {
      if (!is_usable_quaternion(glm::length(rotation_at(frames, frames.times[i])))) {
        model_.fail(name + ": key frame " + std::to_string(i) + " is no unit quaternion");
      }
    }
  }

  const Model& model_;
  std::string animation_;
  std::uint64_t read_ = 0;
};

}  // namespace

std::size_t morph_target_count(const Model& model, int mesh) {
  const tinygltf::Mesh& source = model.at(model.data().meshes, mesh, "mesh", "a node");
  const std::size_t count = source.primitives.empty() ? 0 : source.primitives.front().targets.size();
  for (const tinygltf::Primitive& primitive : source.primitives) {
    if (primitive.targets.size() != count) {
      model.fail("mesh " + std::to_string(mesh) +
                 ": its primitives must have the same number of morph targets");
    }
  }
  if (!source.weights.empty()) {
    check_weights(model, source.weights, count, "mesh " + std::to_string(mesh));
  }
  return count;
}

const std::vector<double>* default_weights(const Model& model, int node, std::size_t count) {
  const tinygltf::Node& source = model.data().nodes[static_cast<std::size_t>(node)];
  if (!source.weights.empty()) {
    check_weights(model, source.weights, count, "node " + std::to_string(node));
    return &source.weights;
  }
  const std::vector<double>& weights = model.data().meshes[static_cast<std::size_t>(source.mesh)].weights;
  return weights.empty() ? nullptr : &weights;
}

Animation::Path Animation::path_of(const Model& model, const std::string& path, const std::string& name) {
  static constexpr std::array<std::string_view, 4> paths = {"translation", "rotation", "scale", "weights"};
  const auto* const found = std::find(paths.begin(), paths.end(), path);
  if (found == paths.end()) {
    model.fail(name + " changes '" + sim::shown(path) +
               "'; known are translation, rotation, scale and weights");
  }
  return static_cast<Path>(found - paths.begin());
}

Animation::Animation(const Model& model, int index) {
  const tinygltf::Animation& source = model.data().animations[static_cast<std::size_t>(index)];
  const std::string prefix = "animation " + std::to_string(index);
  name_ = source.name;
  TrackReader reader(model, prefix);
  std::set<std::pair<int, Path>> targets;
  std::uint64_t changed = 0;
  std::map<std::pair<int, std::size_t>, std::size_t> known;  // tracks by sampler and kind of value
  std::map<int, std::size_t> morphs;                         // morph targets by mesh
  for (std::size_t i = 0; i < source.channels.size(); ++i) {
    const tinygltf::AnimationChannel& channel = source.channels[i];
    const std::string name = prefix + ", channel " + std::to_string(i);
    const Path path = path_of(model, channel.target_path, name);
    const tinygltf::Node& node = model.at(model.data().nodes, channel.target_node, "node", name);
    if (!targets.emplace(channel.target_node, path).second) {
      model.fail(name + " changes the " + channel.target_path + " of node " +
                 std::to_string(channel.target_node) + ", which another channel changes already");
    }
    std::size_t width = path == Path::rotation ? 4 : 3;
    if (path == Path::weights) {
      if (node.mesh >= 0 && morphs.find(node.mesh) == morphs.end()) {
        morphs[node.mesh] = morph_target_count(model, node.mesh);
      }
      width = node.mesh < 0 ? 0 : morphs[node.mesh];
      if (width == 0) {
        model.fail(name + " changes the weights of node " + std::to_string(channel.target_node) +
                   ", which has no mesh with morph targets");
      }
    } else if (!node.matrix.empty()) {
      model.fail(name + " changes the " + channel.target_path + " of node " +
                 std::to_string(channel.target_node) + ", which has a matrix instead");
    }
    const tinygltf::AnimationSampler& sampler = model.at(source.samplers, channel.sampler, "sampler", name);
    // One sampler may serve weights of one target, three numbers and four: each use is checked separately.
    const auto key = std::pair(channel.sampler, path == Path::weights ? width + 4 : width);
    auto track = known.find(key);
    if (track == known.end()) {
      const bool only_floats = path == Path::translation || path == Path::scale;
      tracks_.push_back(reader.read(sampler, prefix + ", sampler " + std::to_string(channel.sampler), width,
                                    only_floats, path == Path::rotation));
      track = known.emplace(key, tracks_.size() - 1).first;
      duration_ = std::max(duration_, tracks_.back().times.back());
    }
    channels_.push_back({channel.target_node, path, track->second});
    // A pose holds a copy of everything that changes.
    changed += width;
    if (changed > model.options().max_triangles) {
      model.fail(prefix + " changes more than " + std::to_string(model.options().max_triangles) +
                 " numbers, which is more than is accepted");
    }
  }
}

std::uint64_t Animation::size() const {
  std::uint64_t numbers = 0;
  for (const KeyFrames& track : tracks_) {
    numbers += track.times.size() + track.values.size();
  }
  return numbers;
}

NodeChanges Animation::at(double seconds) const {
  NodeChanges changes;
  for (const Channel& channel : channels_) {
    const KeyFrames& track = tracks_[channel.track];
    NodeChange& change = changes[channel.node];
    if (channel.path == Path::rotation) {
      change.rotation = rotation_at(track, seconds);
      continue;
    }
    std::vector<double> value = value_at(track, seconds);
    if (channel.path == Path::weights) {
      change.weights = std::move(value);
    } else {
      (channel.path == Path::translation ? change.translation : change.scale) =
          glm::dvec3(value[0], value[1], value[2]);
    }
  }
  return changes;
}

int chosen_animation(const Model& model) {
  const std::string& choice = model.options().animation;
  const std::vector<tinygltf::Animation>& animations = model.data().animations;
  if (choice.empty()) {
    return animations.empty() ? -1 : 0;
  }
  std::vector<std::string> names;
  for (const tinygltf::Animation& animation : animations) {
    names.push_back(animation.name);
  }
  if (choice == "none" && std::find(names.begin(), names.end(), choice) == names.end()) {
    return -1;
  }
  if (animations.empty()) {
    model.fail_choice("animation",
                      "animation '" + sim::shown(choice) + "' is asked for, but the file has no animation");
  }
  return chosen_index(model, choice, "animation", names);
}

}  // namespace marti::scenes::gltf
