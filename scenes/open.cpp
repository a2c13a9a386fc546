#include "scenes/open.h"

#include <algorithm>
#include <cctype>

#include "scenes/procedural.h"
#include "sim/error.h"

namespace marti::scenes {

namespace {

bool names_a_file(std::string_view spec) {
  std::string lower(spec);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower.ends_with(".gltf") || lower.ends_with(".glb");
}

}  // namespace

Scene open_scene(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode) {
  if (names_a_file(spec)) {
    // An absolute path on the right replaces the base directory.
    return load_gltf(options.base_directory / std::filesystem::path(spec), options.gltf, decode);
  }
  Scene scene = make_procedural(spec);
  const std::string where = "scene '" + std::string(spec) + "': ";
  if (!options.gltf.scene.empty() || !options.gltf.camera.empty()) {
    throw sim::UserError(where + "a procedural scene has one camera and no parts to choose from");
  }
  if (options.gltf.frame != 0) {
    throw sim::UserError(where + "a procedural scene has only frame 0");
  }
  return scene;
}

}  // namespace marti::scenes
