// Queries of tests about a scene that was loaded.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "scenes/scene.h"

namespace marti::scenes::testing {

inline glm::dvec3 corner(const Scene& scene, std::size_t triangle, std::size_t i) {
  return scene.positions[scene.triangles[triangle].vertex[i]];
}

/// Whether one of the scene's notes holds `part`.
inline bool has_note(const Scene& scene, const std::string& part) {
  return std::any_of(scene.notes.begin(), scene.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace marti::scenes::testing
