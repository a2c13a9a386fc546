// What the readers of scene files are told: which parts to use, how images are read, and the limits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "scenes/texture.h"
#include "sim/memory_budget.h"

namespace marti::scenes {

/// Whether a scene is given a directional light over the camera's shoulder and ambient light.
enum class DefaultLight : std::uint8_t { automatic, always, never };
inline constexpr std::array<std::string_view, 3> default_light_names = {"auto", "always", "never"};

/// What becomes of meshes that several nodes share. automatic: they are kept where copies would be more than
/// many_copies triangles.
enum class Instances : std::uint8_t { automatic, copied, kept };
inline constexpr std::array<std::string_view, 3> instances_names = {"auto", "copied", "kept"};
inline constexpr std::uint64_t many_copies = 4'000'000;

/// A view of the user's own: what is given replaces what the scene has.
struct ViewOptions {
  std::optional<glm::dvec3> eye;
  std::optional<glm::dvec3> look_at;
  std::optional<glm::dvec3> up;
  std::optional<double> vertical_fov;  ///< full angle in radians, above 0 and below pi
};

/// The user's own sky and sun.
struct SkyOptions {
  /// Linear RGB, 0 to 1e9: what is seen where there is nothing, and the ambient light, in place of the
  /// scene's.
  std::optional<glm::dvec3> sky;
  /// The direction towards the sun, not 0: a directional light beside the scene's own.
  std::optional<glm::dvec3> sun;
  glm::dvec3 sun_color{1.0};  ///< 0 to 1e9, as Light::color
};

struct FileOptions {
  std::string scene;   ///< index or name; empty: the file's default, else the first
  std::string camera;  ///< index or name of a camera of the file; empty: the scene's first perspective one
  ViewOptions view;    ///< instead of the camera, or of parts of it, in every pose
  SkyOptions sky;      ///< also in every pose
  /// Index or name of the animation that plays; empty: the first, if the file has one; "none": the static
  /// pose, unless an animation has that name.
  std::string animation;
  double time = 0.0;  ///< of the pose that is asked for: seconds from the animation's beginning
  /// automatic: only a scene that has no light and does not say that none is missing (Scene::lights_are_all).
  DefaultLight default_light = DefaultLight::automatic;
  Instances instances = Instances::copied;
  bool emitters_light =
      false;                ///< triangles that emit light count as lights: paths and shadow rays find them
  bool sky_lights = false;  ///< so does a sky: paths find it
  /// Refuses what else is replaced with a note because many files are so: docs/scenes.md lists it.
  bool strict = false;
  /// If set, images are not decoded: textures have their size and their file, but no texels (see
  /// decode_texels).
  ImageSizer size_only;
  /// If set without `size_only`: gives an image's size before it is decoded, so that an image too large for
  /// `memory` is refused first.
  ImageSizer size_first;
  /// Also reads and checks parts that the scene does not use: all images, and all accessors of numbers.
  bool read_unused = false;
  std::uint64_t max_triangles = std::uint64_t{1} << 25;  ///< more than this is refused; also for vertices
  std::uint64_t max_file_bytes = (std::uint64_t{1} << 32) - 1;  ///< of each file read
  /// The memory that the files, the scene made of them and its textures may take together. Instances are
  /// counted before they are expanded, texels before they are decoded.
  sim::MemoryBudget memory;
};

}  // namespace marti::scenes
