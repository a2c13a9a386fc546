// Internal to scenes/: what a reader leaves out of a file, and the notes about it.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "scenes/scene.h"

namespace marti::scenes {

/// What a reader leaves out, with counts.
struct LeftOut {
  std::map<std::string, std::uint64_t> features;  ///< by a description in the plural
};

/// A note for each feature with a count above 0.
void note_left_out(const LeftOut& left_out, Scene& scene);

/// A note that `count` of all polygons, in this `kind` of file "triangles" or "polygons", are left out
/// because of their positions, if there are any.
void note_bad_positions(std::uint64_t count, const char* kind, Scene& scene);

/// A note that counts the triangles without area, if there are any.
void note_degenerate(Scene& scene);

}  // namespace marti::scenes
