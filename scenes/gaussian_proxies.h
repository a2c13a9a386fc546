// Internal to scenes/: Gaussians from their trainers' terms, and the proxies by which rays find them.
#pragma once

#include <cstdint>
#include <optional>

#include <glm/ext/quaternion_double.hpp>
#include <glm/vec3.hpp>

#include "scenes/file_options.h"
#include "scenes/gaussians.h"
#include "scenes/scene.h"

namespace marti::scenes {

/// A Gaussian in its trainer's terms.
struct Splat {
  glm::dvec3 center{0.0};
  glm::dvec3 deviation{1.0};  ///< standard deviations along its axes, above 0
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  double opacity = 1.0;
};

/// Nothing for one that no ray sees, because its opacity is not above 1/255 by a millionth. `rotation` need
/// not be of unit length, but have one.
[[nodiscard]] std::optional<Gaussian> gaussian_of(const Splat& splat);

/// Bytes of memory that the proxies of so many Gaussians take.
[[nodiscard]] std::uint64_t bytes_of_proxies(std::uint64_t gaussians, Instances wanted);

/// Stands a grey proxy about each of the Gaussians of a scene that has nothing else: instances if they are
/// kept, else copies. Throws KeyError for more copies than `most_triangles`, and UserError for a Gaussian
/// that is too large or too small for its place.
void stand_proxies(Scene& scene, Instances wanted, std::uint64_t most_triangles);

}  // namespace marti::scenes
