// Internal to scenes/: light sources of pbrt files.
#pragma once

#include <optional>
#include <string>

#include "scenes/pbrt_text.h"
#include "scenes/scene.h"
#include "scenes/scene_notes.h"

namespace marti::scenes::pbrt {

/// The light of a statement LightSource in its own coordinates; nothing for an infinite one, which is added
/// to the sky of the scene. Throws UserError for kinds that pbrt does not have and parameters out of range.
[[nodiscard]] std::optional<Light> light_source(const std::string& kind, const Parameters& parameters,
                                                Scene& scene, LeftOut& left_out);

}  // namespace marti::scenes::pbrt
