// Internal to scenes/: the geometry of one scene behind that of another.
#pragma once

#include <cstdint>

#include "scenes/scene.h"

namespace marti::scenes {

/// Whether both together have at most `most` triangles, curved primitives and vertices each.
[[nodiscard]] bool fit_together(const Scene& whole, const Scene& part, std::uint64_t most);

/// Adds vertices, triangles and curved primitives of `part` to `to`, whose material `first_material` is the
/// part's first; polygons and curved primitives are numbered on. Vertices without a normal or texture
/// coordinates get zeros where others have them. What is left of `part` is its other parts.
void append_geometry(Scene& to, Scene& part, std::uint32_t first_material);

}  // namespace marti::scenes
