// Queries of tests about a scene that was loaded.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>

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

/// Whether one of the scene's notes holds `part`.
inline bool has_note(const Scene& scene, const std::string& part) {
  return std::any_of(scene.notes.begin(), scene.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace marti::scenes::testing
