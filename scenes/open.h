// Opens any scene, a file or a recipe, from the text that the user wrote.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "scenes/animated.h"
#include "scenes/file_options.h"
#include "scenes/scene.h"
#include "scenes/texture.h"

namespace marti::scenes {

struct OpenOptions {
  std::filesystem::path base_directory;  ///< of relative file names; empty: the current directory
  FileOptions file;                      ///< which parts of a file to use, and limits
  /// If not empty, the file of Scene::rays (given_rays.h), by which the camera is of no use.
  std::filesystem::path rays{};
};

/// The endings of the names of files that can be read, without the dot.
inline constexpr std::array<std::string_view, 6> file_endings = {"gltf", "glb",  "obj",
                                                                 "ply",  "pbrt", "camera"};

/// Opens `spec`: a file when it has one of these endings (in any case), a folder of such files
/// (scenes/folder.h) when it ends with a slash, a list of these (scenes/scene_list.h) when it begins with a
/// bracket or a brace, else a procedural scene such as "teapot:12"; all but glTF files have one pose. A
/// camera file holds no scene and is for folders and lists. `options.file.time` is ignored. Choosing a scene,
/// a camera or an animation other than "none" is an error for all but a glTF file. Throws UserError as
/// open_gltf, open_obj, open_ply, open_pbrt, open_folder and make_procedural do.
[[nodiscard]] AnimatedScene open_animated(std::string_view spec, const OpenOptions& options,
                                          const ImageDecoder& decode);

/// Whether `spec`, which is no list, is the name of a file or a folder, by its ending, rather than of a
/// procedural scene.
[[nodiscard]] bool names_a_file(std::string_view spec);
/// Whether it is the name of a camera file (scenes/camera_file.h).
[[nodiscard]] bool names_a_camera(std::string_view spec);
/// Whether opening `spec`, which may be a list, reads files. Throws UserError as read_scene_list() does.
[[nodiscard]] bool reads_files(std::string_view spec);
/// What `spec`, whose relative names of files begin in `directory`, is from anywhere. Throws as
/// reads_files().
[[nodiscard]] std::string source_from(std::string_view spec, const std::filesystem::path& directory);
/// `spec` for people: a list in few words. Throws as reads_files().
[[nodiscard]] std::string short_source(std::string_view spec);

/// The pose at `options.file.time`, with the rays of `options.rays`. A time other than 0 is an error if the
/// scene does not move; one in the rays is a KeyError about image.rays. Unless `use` is null, it receives how
/// much of its file the scene uses.
[[nodiscard]] Scene open_scene(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode,
                               FileUse* use = nullptr);

/// The counts that describe a scene.
struct SceneFacts {
  std::string name;
  std::uint64_t polygons = 0;  ///< polygons of the source
  std::uint64_t triangles = 0;
  std::uint64_t spheres = 0;
  std::uint64_t cylinders = 0;
  std::uint64_t cones = 0;
  std::uint64_t vertices = 0;              ///< as stored
  std::uint64_t distinct_positions = 0;    ///< of triangles' corners, compared bit for bit
  std::uint64_t degenerate_triangles = 0;  ///< without an area (scene.h, has_no_area)
  std::uint64_t duplicate_triangles = 0;   ///< with the same three positions as an earlier one, in any order
  std::uint64_t materials = 0;
  std::uint64_t textures = 0;
  std::uint64_t texels = 0;
  std::uint64_t lights = 0;
  Bounds bounds;
};

/// Bytes of host memory that the scene's vertices, primitives and decoded texels take.
[[nodiscard]] std::uint64_t host_bytes(const Scene& scene);
/// Bytes of host memory that facts_of() takes in addition, while it sorts.
[[nodiscard]] std::uint64_t host_bytes_of_facts(const Scene& scene);

/// The number of triangles without an area (scene.h, has_no_area). Takes time proportional to the number of
/// triangles.
[[nodiscard]] std::uint64_t count_degenerate(const Scene& scene);

/// Counts everything in SceneFacts; sorts positions and triangles to compare them.
[[nodiscard]] SceneFacts facts_of(const Scene& scene);

/// The facts as text, one "name: value" line each, with the scene's notes at the end.
[[nodiscard]] std::string describe(const Scene& scene);

}  // namespace marti::scenes
