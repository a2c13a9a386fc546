// Internal to scenes/: lights and cameras of a glTF file, and default ones if it has none.
#pragma once

#include <vector>

#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/scene.h"

namespace marti::scenes::gltf {

/// Adds the KHR_lights_punctual lights of the placed nodes.
void add_lights(const Model& model, const std::vector<PlacedNode>& nodes, Scene& scene);

/// Sets the camera that the options ask for, or the first perspective one. False when the scene has none.
[[nodiscard]] bool set_camera(const Model& model, const std::vector<PlacedNode>& nodes, Scene& scene);

/// A camera that sees the whole scene, from a little above on the +z side. The scene has triangles.
void frame_camera(Scene& scene);

/// A directional light over the camera's shoulder and some ambient light.
void add_default_light(Scene& scene);

}  // namespace marti::scenes::gltf
