// Internal to scenes/: camera and lights of scenes whose file has none, and views, skies and suns of the
// user's own.
#pragma once

#include <string_view>

#include "scenes/file_options.h"
#include "scenes/scene.h"

namespace marti::scenes {

inline constexpr std::string_view no_camera_note =
    "The scene has no perspective camera; it is seen by one that frames it.";

/// Makes a camera that sees the whole scene, from a little above on the +z side, with the field of view that
/// `view` asks for, and sets Scene::framed. The scene has triangles.
void frame_camera(const ViewOptions& view, Scene& scene);

/// Puts what `view` gives in the place of the camera's own. Throws PartError when they do not span a view:
/// the eye at the point looked at, or up along the line between them.
void apply_view(const ViewOptions& view, Scene& scene);

/// Gives the scene, which has its camera and its own lights, the sky and the sun of `options`; then, where
/// they ask for it, a directional light over the camera's shoulder and ambient light of at least 0.2, with a
/// note. New lights follow the scene's own.
void add_light(Scene& scene, const FileOptions& options);

/// All of these for a scene of one pose that has its own lights: a camera, with a note, only where `framed`
/// asks for one.
void set_view(Scene& scene, const FileOptions& options);

}  // namespace marti::scenes
