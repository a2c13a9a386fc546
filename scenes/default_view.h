// Internal to scenes/: camera and lights of scenes whose file has none.
#pragma once

#include <string_view>

#include "scenes/scene.h"

namespace marti::scenes {

inline constexpr std::string_view no_camera_note =
    "The scene has no perspective camera; it is seen by one that frames it.";
inline constexpr std::string_view no_light_note =
    "The scene has no light; it is lit by a directional one over the camera's shoulder and by ambient light.";

/// A camera that sees the whole scene, from a little above on the +z side. The scene has triangles.
void frame_camera(Scene& scene);

/// A directional light over the camera's shoulder and some ambient light.
void add_default_light(Scene& scene);

}  // namespace marti::scenes
