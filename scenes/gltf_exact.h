// Internal to scenes/: the 64-bit numbers that export_glb writes beside those that glTF holds rounded. They
// count only where they still are what the file says: another program may have changed the one and kept the
// other.
#pragma once

#include <glm/vec3.hpp>

#include "scenes/gltf_model.h"
#include "scenes/scene.h"

namespace marti::scenes::gltf {

/// The buffer view that `extras` of a primitive name for an attribute, -1 if there is none.
[[nodiscard]] int exact_view(const Model& model, const tinygltf::Value& extras, const char* semantic);

/// Replaces each of the accessor's values by the double of the buffer view at its place, if that rounds to
/// it. The view is one of exact_view(); with -1 and with a view of another length nothing is replaced.
void restore_values(const Model& model, int view, const std::string& user, std::vector<double>& values);

/// Members "color", "direction", "cos_inner_cone" and "cos_outer_cone" of `own`, where they agree with the
/// light to 1e-9.
void restore_light(const tinygltf::Value& own, Light& light);

/// Members "at" and "up" of `own`, if the view through them agrees with the camera's to 1e-9.
void restore_camera(const tinygltf::Value& own, Camera& camera);

}  // namespace marti::scenes::gltf
