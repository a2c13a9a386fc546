// Internal to scenes/: lights and cameras of a glTF file.
#pragma once

#include <vector>

#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/scene.h"

namespace marti::scenes::gltf {

/// Adds the KHR_lights_punctual lights of the placed nodes. A range of 0, which glTF does not allow, is none;
/// `left_out` counts these.
void add_lights(const Model& model, const std::vector<PlacedNode>& nodes, Scene& scene, LeftOut& left_out);

/// Sets the camera that the options ask for, or the first perspective one. False when the scene has none.
[[nodiscard]] bool set_camera(const Model& model, const std::vector<PlacedNode>& nodes, Scene& scene);

}  // namespace marti::scenes::gltf
