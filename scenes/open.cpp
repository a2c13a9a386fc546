#include "scenes/open.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "scenes/default_view.h"
#include "scenes/folder.h"
#include "scenes/gltf.h"
#include "scenes/obj.h"
#include "scenes/part_error.h"
#include "scenes/pbrt.h"
#include "scenes/ply.h"
#include "scenes/procedural.h"
#include "scenes/scene_list.h"
#include "sim/key_error.h"
#include "sim/sha256.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

/// One of file_endings; empty for a procedural scene.
std::string ending_of(std::string_view spec) {
  const std::size_t dot = spec.rfind('.');
  std::string ending(dot == std::string_view::npos ? std::string_view() : spec.substr(dot + 1));
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool known = std::find(file_endings.begin(), file_endings.end(), ending) != file_endings.end();
  return known ? ending : std::string();
}

// operator/ returns the right-hand path if that is absolute.
std::filesystem::path path_of(std::string_view spec, const OpenOptions& options) {
  return options.base_directory / std::filesystem::path(spec);
}

/// Throws PartError when a part is asked for of a scene of this `kind`, which has none.
void refuse_parts(std::string_view spec, const char* kind, const FileOptions& options) {
  const std::string where = "scene '" + sim::shown(spec) + "': ";
  if (!options.scene.empty() || !options.camera.empty()) {
    throw PartError(options.scene.empty() ? "camera" : "scene",
                    where + kind + " has one camera and no parts to choose from");
  }
  if (!options.animation.empty() && options.animation != "none") {
    throw PartError("animation", where + kind + " has no animations");
  }
}

/// Throws UserError when `spec`, which names no recipe, is a folder without the slash that says so.
void refuse_folder(std::string_view spec, const OpenOptions& options) {
  const std::string_view name = spec.substr(0, spec.find(':'));
  const std::span<const ProceduralScene> recipes = procedural_scenes();
  std::error_code error;
  if (std::none_of(recipes.begin(), recipes.end(), [&](const auto& recipe) { return recipe.name == name; }) &&
      std::filesystem::is_directory(path_of(spec, options), error)) {
    throw sim::UserError("scene '" + sim::shown(spec) + "' is a folder: write '" + sim::shown(spec) +
                         "/' for all scene files in it");
  }
}

/// Which rays they are: the name without its folder, so that the note is the same from any directory.
std::string note_of(const GivenRays& given, const std::filesystem::path& file) {
  const auto any = std::count(given.any.begin(), given.any.end(), true);
  return "Rays of " + sim::shown(file.filename().string()) + ": " + std::to_string(given.rays.size()) +
         (any == 0 ? "" : ", " + std::to_string(any) + " of them for any hit") + "; SHA-256 " +
         sim::sha256_of_file(file).substr(0, 16) + "...";
}

}  // namespace

bool names_a_file(std::string_view spec) { return spec.ends_with('/') || !ending_of(spec).empty(); }

bool names_a_camera(std::string_view spec) { return ending_of(spec) == "camera"; }

bool reads_files(std::string_view spec) {
  if (!is_scene_list(spec)) {
    return names_a_file(spec);
  }
  const std::vector<ListedScene> entries = read_scene_list(spec);
  return std::any_of(entries.begin(), entries.end(),
                     [](const ListedScene& entry) { return names_a_file(entry.source); });
}

std::string source_from(std::string_view spec, const std::filesystem::path& directory) {
  return is_scene_list(spec)  ? scene_list_from(spec, directory)
         : names_a_file(spec) ? (directory / spec).lexically_normal().string()
                              : std::string(spec);
}

std::string short_source(std::string_view spec) {
  return is_scene_list(spec) ? name_of_scene_list(spec) : std::string(spec);
}

AnimatedScene open_animated(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode) {
  if (is_scene_list(spec)) {
    refuse_parts(short_source(spec), "a list", options.file);
    return open_scene_list(spec, options, decode);
  }
  const std::string ending = ending_of(spec);
  if (ending == "gltf" || ending == "glb") {
    return open_gltf(path_of(spec, options), options.file, decode);
  }
  if (ending == "obj") {
    refuse_parts(spec, "an OBJ file", options.file);
    return open_obj(path_of(spec, options), options.file, decode);
  }
  if (ending == "ply") {
    refuse_parts(spec, "a PLY file", options.file);
    return open_ply(path_of(spec, options), options.file);
  }
  if (ending == "pbrt") {
    refuse_parts(spec, "a pbrt file", options.file);
    return open_pbrt(path_of(spec, options), options.file, decode);
  }
  if (ending == "camera") {
    throw sim::UserError("scene '" + sim::shown(spec) +
                         "' is a camera by itself: name it in a list beside the files that it looks at");
  }
  if (spec.ends_with('/')) {
    refuse_parts(spec, "a folder", options.file);
    return open_folder(path_of(spec, options), options.file, decode);
  }
  refuse_folder(spec, options);
  Scene scene = make_procedural(spec, options.file.memory, options.file.instances);
  refuse_parts(spec, "a procedural scene", options.file);
  set_view(scene, options.file);
  return AnimatedScene(std::move(scene));
}

Scene open_scene(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode,
                 FileUse* use) {
  const std::string name = names_a_file(spec) ? sim::shown(path_of(spec, options).string())
                                              : "scene '" + sim::shown(short_source(spec)) + "'";
  const AnimatedScene scene = open_animated(spec, options, decode);
  if (use != nullptr) {
    *use = scene.file_use();
  }
  Scene pose = scene.asked_for(options.file.time, name);
  if (!options.rays.empty()) {
    pose.rays = sim::KeyError::reported_under("image.rays",
                                              [&] { return read_rays(options.rays, options.file.memory); });
    std::erase(pose.notes, no_camera_note);
    pose.notes.push_back(note_of(pose.rays, options.rays));
  }
  return pose;
}

}  // namespace marti::scenes
