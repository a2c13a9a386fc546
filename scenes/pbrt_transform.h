// Internal to scenes/: the current transform of a pbrt file.
#pragma once

#include <string>
#include <string_view>

#include <glm/mat4x4.hpp>

#include "scenes/pbrt_text.h"
#include "scenes/placement.h"

namespace marti::scenes::pbrt {

/// Whether a statement changes the transform by its numbers: Identity, Translate, Scale, Rotate, LookAt,
/// Transform or ConcatTransform.
[[nodiscard]] bool is_transform(std::string_view statement);

/// The transform after such a statement, whose numbers are read. Throws UserError when they make no transform
/// that can be turned back.
[[nodiscard]] glm::dmat4 transform_by(const std::string& statement, Text& text, const glm::dmat4& before);

/// The transform as an affine map. Throws UserError when it is not affine, or singular (is_singular).
[[nodiscard]] Placement placement_of(const glm::dmat4& transform, const Text& text);

}  // namespace marti::scenes::pbrt
