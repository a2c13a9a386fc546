// One door to every scene: a file or a recipe, by what the user wrote.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "scenes/gltf.h"
#include "scenes/scene.h"
#include "scenes/texture.h"

namespace marti::scenes {

struct OpenOptions {
  std::filesystem::path base_directory;  ///< where a relative file name starts; empty: the current directory
  GltfOptions gltf;                      ///< what to choose from a file
};

/// Opens `spec`: a file when it ends in .gltf or .glb (in any case), else a procedural scene such as
/// "teapot:12". Choosing a scene or camera of a procedural scene is an error, as is any frame but 0.
/// Throws UserError as load_gltf and make_procedural do.
[[nodiscard]] Scene open_scene(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode);

/// The counts that describe a scene.
struct SceneFacts {
  std::string name;
  std::uint64_t polygons = 0;  ///< of the source
  std::uint64_t triangles = 0;
  std::uint64_t spheres = 0;
  std::uint64_t cylinders = 0;
  std::uint64_t cones = 0;
  std::uint64_t vertices = 0;              ///< as stored
  std::uint64_t distinct_positions = 0;    ///< that triangles refer to, compared bit for bit
  std::uint64_t degenerate_triangles = 0;  ///< of exactly no area
  std::uint64_t duplicate_triangles = 0;   ///< with the same three positions as an earlier one, in any order
  std::uint64_t materials = 0;
  std::uint64_t textures = 0;
  std::uint64_t texels = 0;
  std::uint64_t lights = 0;
  Bounds bounds;
};

/// How many triangles have exactly no area. In time proportional to their number.
[[nodiscard]] std::uint64_t count_degenerate(const Scene& scene);

/// Sorts positions and triangles to compare them.
[[nodiscard]] SceneFacts facts_of(const Scene& scene);

/// The facts as text, one "name: value" line each, with the scene's notes at the end.
[[nodiscard]] std::string describe(const Scene& scene);

}  // namespace marti::scenes
