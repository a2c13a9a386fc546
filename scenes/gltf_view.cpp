#include "scenes/gltf_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include <glm/geometric.hpp>

#include "scenes/gltf_exact.h"
#include "scenes/gltf_material.h"
#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes::gltf {

namespace {

constexpr double largest_intensity = 1e12;
constexpr double largest_distance = 1e30;

/// The unit vector along a column of a transform; UserError when the column has length 0.
glm::dvec3 axis_of(const Model& model, const glm::dmat4& world, int column, const std::string& name) {
  const glm::dvec3 axis(world[column]);
  const double length = glm::length(axis);
  if (!(length > 1e-150 && length < 1e150)) {
    model.fail(name + ": its node's transform leaves it no direction");
  }
  return axis / length;
}

glm::dvec3 place_of(const Model& model, const glm::dmat4& world, const std::string& name) {
  const glm::dvec3 place(world[3]);
  for (int axis = 0; axis < 3; ++axis) {
    checked_number(model, place[axis], -largest_distance, largest_distance, name + ": its place");
  }
  return place;
}

LightKind kind_of(const Model& model, const std::string& type, const std::string& name) {
  if (type == "point") {
    return LightKind::point;
  }
  if (type == "directional") {
    return LightKind::directional;
  }
  if (type != "spot") {
    model.fail(name + " is of type '" + sim::shown(type) + "'; known are point, directional and spot");
  }
  return LightKind::spot;
}

/// tinygltf makes no difference between a range of 0 and none.
bool has_range_of_0(const tinygltf::Model& file, int light) {
  const auto found = file.extensions.find("KHR_lights_punctual");
  return found != file.extensions.end() && found->second.IsObject() && found->second.Has("lights") &&
         found->second.Get("lights").IsArray() &&
         number_in(found->second.Get("lights").Get(light), "range") == 0.0;
}

Light convert_light(const Model& model, int index, const PlacedNode& place) {
  const tinygltf::Light& source =
      model.at(model.data().lights, index, "light", "node " + std::to_string(place.node));
  const std::string name = "light " + std::to_string(index);
  Light light;
  light.kind = kind_of(model, source.type, name);
  light.position = place_of(model, place.world, name);
  if (light.kind != LightKind::point) {
    light.direction = -axis_of(model, place.world, 2, name);
  }
  if (!source.color.empty() && source.color.size() != 3) {
    model.fail(name + ": a colour has 3 numbers");
  }
  const double intensity =
      checked_number(model, source.intensity, 0.0, largest_intensity, name + ": its intensity");
  light.color = glm::dvec3(intensity);
  for (std::size_t i = 0; i < source.color.size(); ++i) {
    light.color[static_cast<int>(i)] *=
        checked_number(model, source.color[i], 0.0, largest_intensity, name + ": its colour");
  }
  light.range = checked_number(model, source.range, 0.0, largest_distance, name + ": its range");
  light.inverse_square = light.kind != LightKind::directional;
  if (light.kind == LightKind::spot) {
    const double outer = checked_number(model, source.spot.outerConeAngle, 0.0, std::numbers::pi / 2.0 + 1e-9,
                                        name + ": its outer cone");
    const double inner =
        checked_number(model, source.spot.innerConeAngle, 0.0, outer, name + ": its inner cone");
    light.cos_inner_cone = std::cos(inner);
    light.cos_outer_cone = std::cos(outer);
  }
  if (const tinygltf::Value* own = own_extras(source.extras)) {
    restore_light(*own, light);
    if (own->Has("inverse_square") && own->Get("inverse_square").IsBool()) {
      light.inverse_square = light.inverse_square && own->Get("inverse_square").Get<bool>();
    }
  }
  return light;
}

Camera convert_camera(const Model& model, const PlacedNode& place, int index) {
  const std::string name = "camera " + std::to_string(index);
  const tinygltf::Camera& source = model.data().cameras[static_cast<std::size_t>(index)];
  const double fov = source.perspective.yfov;
  // glTF 2.0 requires more than 0 and less than pi; narrower or wider views are taken for mistakes.
  constexpr double least = 1e-6;
  if (!(fov > least && fov < std::numbers::pi - least)) {
    std::ostringstream text;
    text << name
         << ": its vertical field of view must be above 1e-6 and below pi - 1e-6 radians (0.000057 to "
         << "179.99994 degrees), not " << fov;
    model.fail(text.str());
  }
  Camera camera;
  camera.vertical_fov = fov;
  camera.eye = place_of(model, place.world, name);
  camera.up = axis_of(model, place.world, 1, name);
  // A point at this distance gives an exact direction even if the eye is far from the origin.
  const double distance = std::max(1.0, glm::length(camera.eye));
  camera.at = camera.eye - distance * axis_of(model, place.world, 2, name);
  try {
    static_cast<void>(camera.image_plane(1, 1));
  } catch (const sim::UserError& error) {
    model.fail(name + ": " + error.what());
  }
  if (const tinygltf::Value* own = own_extras(source.extras)) {
    restore_camera(*own, camera);
  }
  return camera;
}

}  // namespace

void add_lights(const Model& model, const std::vector<PlacedNode>& nodes, Scene& scene, LeftOut& left_out) {
  for (const PlacedNode& place : nodes) {
    const tinygltf::Node& node = model.data().nodes[static_cast<std::size_t>(place.node)];
    const auto found = node.extensions.find("KHR_lights_punctual");
    if (!place.of_file || found == node.extensions.end()) {
      continue;
    }
    const std::optional<int> index = index_in(found->second, "light");
    if (!index) {
      model.fail("node " + std::to_string(place.node) + ": its KHR_lights_punctual names no light");
    }
    scene.lights.push_back(convert_light(model, *index, place));
    if (has_range_of_0(model.data(), *index)) {
      left_out.replace("ranges of lights that are 0, by none", sim::shown(model.path().string()) +
                                                                   ": light " + std::to_string(*index) +
                                                                   ": its range is 0; it must be above that");
    }
  }
}

bool set_camera(const Model& model, const std::vector<PlacedNode>& nodes, Scene& scene) {
  const std::vector<tinygltf::Camera>& cameras = model.data().cameras;
  int wanted = -1;
  if (!model.options().camera.empty()) {
    std::vector<std::string> names;
    for (const tinygltf::Camera& camera : cameras) {
      names.push_back(camera.name);
    }
    wanted = chosen_index(model, model.options().camera, "camera", names);
    if (cameras[static_cast<std::size_t>(wanted)].type != "perspective") {
      model.fail_choice("camera", "camera '" + sim::shown(model.options().camera) + "' is " +
                                      sim::shown(cameras[static_cast<std::size_t>(wanted)].type) +
                                      "; only perspective cameras can be used");
    }
  }
  for (const PlacedNode& place : nodes) {
    const int index = model.data().nodes[static_cast<std::size_t>(place.node)].camera;
    if (index < 0) {
      continue;
    }
    const tinygltf::Camera& camera = model.at(cameras, index, "camera", "node " + std::to_string(place.node));
    if (wanted >= 0 ? index == wanted : camera.type == "perspective") {
      scene.camera = convert_camera(model, place, index);
      return true;
    }
  }
  if (wanted >= 0) {
    model.fail_choice("camera",
                      "camera '" + sim::shown(model.options().camera) + "' is in no node of the scene");
  }
  return false;
}

}  // namespace marti::scenes::gltf
