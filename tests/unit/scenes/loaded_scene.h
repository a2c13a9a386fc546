// Queries of tests about a scene that was loaded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenes/gltf.h"
#include "scenes/scene.h"

namespace marti::scenes::testing {

/// The pose of a file at `options.time`.
inline Scene load_gltf(const std::filesystem::path& path, const FileOptions& options,
                       const ImageDecoder& decode) {
  return open_gltf(path, options, decode).asked_for(options.time, path.string());
}

inline glm::dvec3 corner(const Scene& scene, std::size_t triangle, std::size_t i) {
  return scene.positions[scene.triangles[triangle].vertex[i]];
}

/// Triangles by their corners, to nine digits behind the point, in an order of their own.
inline std::vector<std::array<double, 9>> sorted_triangles(const Scene& scene) {
  std::vector<std::array<double, 9>> all;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    std::array<double, 9>& corners = all.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      for (int a = 0; a < 3; ++a) {
        corners[3 * k + static_cast<std::size_t>(a)] = std::round(corner(scene, t, k)[a] * 1e9);
      }
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Whether one of the scene's notes holds `part`.
inline bool has_note(const Scene& scene, const std::string& part) {
  return std::any_of(scene.notes.begin(), scene.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace marti::scenes::testing
