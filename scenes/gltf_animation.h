// Internal to scenes/: the animations of a glTF file (glTF 2.0.1, section 3.11).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/keyframes.h"

namespace marti::scenes::gltf {

/// The number of morph targets of the primitives of a mesh, which must be equal. Throws UserError.
[[nodiscard]] std::size_t morph_target_count(const Model& model, int mesh);

/// The weights of a node's morph targets without animation: the node's, else the mesh's, else null, which
/// means zeros (section 3.7.4). They live in the model. The node has a mesh with `count` targets. Throws
/// UserError.
[[nodiscard]] const std::vector<double>* default_weights(const Model& model, int node, std::size_t count);

class Animation {
 public:
  /// Decodes and checks all channels. Throws UserError.
  Animation(const Model& model, int index);

  /// The properties that it changes, with their values at a time.
  [[nodiscard]] NodeChanges at(double seconds) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] double duration() const { return duration_; }  ///< seconds, to the last key frame
  [[nodiscard]] std::uint64_t channels() const { return channels_.size(); }
  [[nodiscard]] std::uint64_t size() const;  ///< how many numbers were read

 private:
  enum class Path { translation, rotation, scale, weights };
  struct Channel {
    int node = 0;
    Path path = Path::translation;
    std::size_t track = 0;  // index into tracks_
  };
  static Path path_of(const Model& model, const std::string& path, const std::string& name);

  std::string name_;
  double duration_ = 0.0;
  std::vector<KeyFrames> tracks_;
  std::vector<Channel> channels_;
};

/// The animation that the options ask for, by index or name: empty means the first, "none" no animation
/// (unless one has that name). -1 when none plays. Throws UserError.
[[nodiscard]] int chosen_animation(const Model& model);

}  // namespace marti::scenes::gltf
