#include "scenes/open.h"

#include <algorithm>
#include <cctype>

#include "scenes/part_error.h"
#include "scenes/procedural.h"
#include "sim/shown.h"

namespace marti::scenes {

bool names_a_file(std::string_view spec) {
  std::string lower(spec);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower.ends_with(".gltf") || lower.ends_with(".glb");
}

namespace {

// operator/ returns the right-hand path if that is absolute.
std::filesystem::path path_of(std::string_view spec, const OpenOptions& options) {
  return options.base_directory / std::filesystem::path(spec);
}

Scene open_procedural(std::string_view spec, const GltfOptions& options) {
  Scene scene = make_procedural(spec);
  const std::string where = "scene '" + sim::shown(spec) + "': ";
  if (!options.scene.empty() || !options.camera.empty()) {
    throw PartError(options.scene.empty() ? "camera" : "scene",
                    where + "a procedural scene has one camera and no parts to choose from");
  }
  if (!options.animation.empty() && options.animation != "none") {
    throw PartError("animation", where + "a procedural scene has no animations");
  }
  return scene;
}

}  // namespace

AnimatedScene open_animated(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode) {
  if (names_a_file(spec)) {
    return open_gltf(path_of(spec, options), options.gltf, decode);
  }
  return AnimatedScene(open_procedural(spec, options.gltf));
}

Scene open_scene(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode,
                 FileUse* use) {
  const std::string name =
      names_a_file(spec) ? sim::shown(path_of(spec, options).string()) : "scene '" + sim::shown(spec) + "'";
  const AnimatedScene scene = open_animated(spec, options, decode);
  if (use != nullptr) {
    *use = scene.file_use();
  }
  return scene.asked_for(options.gltf.time, name);
}

}  // namespace marti::scenes
