#include "scenes/default_view.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scenes/part_error.h"

namespace marti::scenes {

namespace {

/// Whether any triangle shines; one without an area does not.
bool has_emitters(const Scene& scene) {
  return std::any_of(scene.triangles.begin(), scene.triangles.end(), [&scene](const Triangle& triangle) {
    const auto corner = [&](std::size_t i) { return scene.positions[triangle.vertex.at(i)]; };
    return scene.materials[triangle.material].emission != glm::dvec3(0.0) &&
           !has_no_area(corner(0), corner(1), corner(2));
  });
}

void add_sky(const SkyOptions& options, Scene& scene) {
  if (options.sky) {
    scene.background = *options.sky;
    scene.ambient = *options.sky;
  }
  if (options.sun) {
    const glm::dvec3 size = glm::abs(*options.sun);
    Light light;
    light.kind = LightKind::directional;
    // Divided first, so that no square is too small or too large for a double.
    light.direction = -glm::normalize(*options.sun / std::max({size.x, size.y, size.z}));
    light.color = options.sun_color;
    scene.lights.push_back(light);
  }
}

/// Where the options ask for it.
void add_default_light(Scene& scene, const FileOptions& options) {
  constexpr const char* added = "a directional one over the camera's shoulder and by ambient light";
  const bool lacks_light = scene.lights.empty() && !scene.lights_are_all;
  const bool emits = lacks_light && has_emitters(scene);
  const bool sky = options.sky_lights && scene.background != glm::dvec3(0.0);
  const bool dark = lacks_light && !sky && !(emits && options.emitters_light);
  if (options.default_light == DefaultLight::never) {
    if (dark && options.emitters_light) {
      scene.notes.emplace_back("The scene has no light: nothing is lit, and no ray looks for a light.");
    }
    return;
  }
  if (options.default_light == DefaultLight::always) {
    scene.notes.push_back(std::string("Besides its own lights the scene is lit by ") + added +
                          ": scene.default_light = \"always\".");
  } else if (dark) {
    scene.notes.push_back(std::string("The scene has no light") +
                          (emits ? " but surfaces that shine, by which only paths are lit" : "") +
                          "; it is lit by " + added + ".");
  } else {
    return;
  }
  const glm::dvec3 sight = glm::normalize(scene.camera.at - scene.camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(sight, scene.camera.up));
  const glm::dvec3 up = glm::cross(right, sight);
  Light light;
  light.kind = LightKind::directional;
  light.direction = glm::normalize(sight + 0.4 * right - 0.6 * up);
  light.color = glm::dvec3(0.8);
  scene.lights.push_back(light);
  scene.ambient = glm::max(scene.ambient, glm::dvec3(0.2));
}

}  // namespace

void frame_camera(const ViewOptions& view, Scene& scene) {
  const Bounds bounds = bounds_of(scene);
  const glm::dvec3 center = bounds.lo + (bounds.hi - bounds.lo) * 0.5;
  const double half_diagonal = glm::length(bounds.hi - bounds.lo) * 0.5;
  const double radius = half_diagonal > 0.0 ? half_diagonal : std::max(1.0, glm::length(center)) * 0.5;
  scene.framed = true;
  scene.camera = Camera{};
  scene.camera.vertical_fov = view.vertical_fov.value_or(scene.camera.vertical_fov);
  scene.camera.at = center;
  const double distance = 1.05 * radius / std::sin(scene.camera.vertical_fov / 2.0);
  scene.camera.eye = center + distance * glm::normalize(glm::dvec3(0.5, 0.4, 1.0));
}

void apply_view(const ViewOptions& view, Scene& scene) {
  if (!view.eye && !view.look_at && !view.up && !view.vertical_fov) {
    return;
  }
  Camera& camera = scene.camera;
  camera.eye = view.eye.value_or(camera.eye);
  camera.at = view.look_at.value_or(camera.at);
  camera.up = view.up.value_or(camera.up);
  camera.vertical_fov = view.vertical_fov.value_or(camera.vertical_fov);
  try {
    static_cast<void>(camera.image_plane(1, 1));
  } catch (const sim::UserError& error) {
    throw PartError(view.look_at ? "look_at" : view.eye ? "eye" : "up", error.what());
  }
}

void add_light(Scene& scene, const FileOptions& options) {
  add_sky(options.sky, scene);
  add_default_light(scene, options);
}

void set_view(Scene& scene, const FileOptions& options) {
  if (scene.framed) {
    frame_camera(options.view, scene);
    if (!options.view.eye) {
      scene.notes.emplace_back(no_camera_note);
    }
  }
  apply_view(options.view, scene);
  add_light(scene, options);
}

}  // namespace marti::scenes
