// Internal to scenes/: several scenes as one, one after the other.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/animated.h"
#include "scenes/merged_instances.h"
#include "scenes/open.h"
#include "scenes/placement.h"
#include "scenes/source_file.h"

namespace marti::scenes {

/// A list and a folder are made of at most so many scenes.
inline constexpr std::size_t most_parts = std::size_t{1} << 16U;

/// Primitives, materials, textures and lights of all parts, in the order in which they are added, each in its
/// static pose. Camera, background and ambient light are those of the first part that has a camera, which a
/// camera file (camera_file.h) is, too.
class MergedScene {
 public:
  /// `whole`: what messages about all parts begin with, and the limits; must outlive this object.
  explicit MergedScene(const SourceFile& whole);

  /// Opens and adds what open_animated() takes, or a camera file; without triangles and quadrics it is left
  /// out. `name` begins its notes and the messages about `placement`, which may be null. Throws UserError as
  /// the readers do, and when all parts are too many or too large.
  void open(std::string_view spec, const std::filesystem::path& base_directory, const ImageDecoder& decode,
            const std::string& name, const Placement* placement = nullptr);

  /// With notes, and with view and lights as the options of `whole` ask for. Throws UserError when nothing
  /// has a primitive.
  [[nodiscard]] AnimatedScene finish(std::string name) &&;

 private:
  void add(Scene part, const std::string& name);
  void add(const FileUse& use);

  const SourceFile& whole_;
  OpenOptions part_;
  Scene scene_;
  MergedInstances instances_;
  std::size_t parts_ = 0;
  FileUse use_;
  std::vector<std::string> without_triangles_;
  std::vector<std::string> mirrored_, not_mirrored_;  // files of pbrt
};

}  // namespace marti::scenes
