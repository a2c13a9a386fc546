// Internal to scenes/: shapes of pbrt files as triangles and curved primitives.
#pragma once

#include <optional>
#include <string>

#include <glm/mat4x4.hpp>

#include "scenes/pbrt_text.h"
#include "scenes/scene.h"
#include "scenes/scene_notes.h"
#include "scenes/source_file.h"

namespace marti::scenes::pbrt {

/// The geometry of a shape in its own coordinates, of material 0; nothing, which is counted, for one that has
/// no surface here. A disk is a polygon of tessellation_sides corners; a triangle whose corners have normals
/// lies so that these are outside. `textured`: a mesh without texture coordinates gets pbrt's. Throws
/// UserError when parameters are missing, broken or out of range.
[[nodiscard]] std::optional<Scene> scene_of_shape(const std::string& kind, const Parameters& parameters,
                                                  bool textured, const SourceFile& file, Text& text,
                                                  LeftOut& left_out);

/// Makes triangles of curved primitives if the transform does not scale alike in all directions.
void to_triangles_if_stretched(Scene& shape, const glm::dmat4& transform);

}  // namespace marti::scenes::pbrt
