// Rays that a file gives: they are traced in the place of those that a camera would send.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

#include "sim/memory_budget.h"

namespace marti::scenes {

/// The points origin + t * direction, t from `least` to `greatest`, which are in units of the direction's
/// length.
struct GivenRay {
  glm::dvec3 origin{0.0};     ///< each coordinate at most 1e30 away from 0
  double least = 0.0;         ///< not negative, finite
  glm::dvec3 direction{0.0};  ///< its largest component from 1e-30 to 1e30
  double greatest = 0.0;      ///< at least `least`; may be infinite
};

struct GivenRays {
  std::vector<GivenRay> rays;
  /// For each ray whether any hit will do; else the closest is wanted, as of all if this is empty.
  std::vector<bool> any;

  [[nodiscard]] bool wants_any(std::size_t ray) const { return !any.empty() && any[ray]; }
};

/// The most rays of a file, as many as an image has pixels.
inline constexpr std::uint64_t most_given_rays = std::uint64_t{1} << 30U;

/// The number of rays, 1 to most_given_rays, of an array of NumPy (.npy) of float32 or float64, the lowest
/// byte first, with a row for each ray: origin, least, direction, greatest, and, if it has nine columns, 0
/// for the closest and 1 for any hit. Reads the header and the file's size alone. Throws UserError, which
/// begins with the file's name, when the file is not such an array.
[[nodiscard]] std::uint64_t count_rays(const std::filesystem::path& file);

/// The rays themselves. Throws UserError, also for a ray out of range, with its number, from 0, and for more
/// than the memory allows.
[[nodiscard]] GivenRays read_rays(const std::filesystem::path& file, const sim::MemoryBudget& memory);

}  // namespace marti::scenes
