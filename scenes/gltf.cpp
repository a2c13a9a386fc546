#include "scenes/gltf.h"

#include <algorithm>
#include <array>
#include <new>
#include <string_view>

#include "scenes/gltf_material.h"
#include "scenes/gltf_mesh.h"
#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/gltf_view.h"
#include "scenes/open.h"

namespace marti::scenes {

namespace {

using gltf::LeftOut;
using gltf::Model;

constexpr std::array<std::string_view, 5> supported_extensions = {
    "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_ior",
    "KHR_materials_transmission", "KHR_mesh_quantization"};

bool is_supported(const std::string& extension) {
  return std::find(supported_extensions.begin(), supported_extensions.end(), extension) !=
         supported_extensions.end();
}

void check_requirements(const Model& model) {
  for (const std::string& extension : model.data().extensionsRequired) {
    if (!is_supported(extension)) {
      model.fail("it requires the extension '" + extension + "', which is not supported");
    }
  }
  if (model.options().frame != 0) {
    model.fail("frame " + std::to_string(model.options().frame) + " is asked for, but " +
               (model.data().animations.empty()
                    ? "the file has no animation"
                    : "animations are not supported: only frame 0, the static pose"));
  }
}

void note_extensions(const Model& model, Scene& scene) {
  std::string names;
  for (const std::string& extension : model.data().extensionsUsed) {
    if (!is_supported(extension)) {
      names += (names.empty() ? "" : ", ");
      names += extension;
    }
  }
  if (!names.empty()) {
    scene.notes.push_back("Optional glTF extensions are ignored: " + names + ".");
  }
}

void note_left_out(const Model& model, const LeftOut& left_out, std::uint64_t bad_triangles, Scene& scene) {
  note_extensions(model, scene);
  for (const auto& [what, count] : left_out.features) {
    if (count > 0) {
      scene.notes.push_back("Left out: " + std::to_string(count) + " " + what + ".");
    }
  }
  if (!model.data().animations.empty()) {
    scene.notes.push_back("The file is animated; this is its static pose.");
  }
  if (bad_triangles > 0) {
    scene.notes.push_back("Left out: " + std::to_string(bad_triangles) + " of " +
                          std::to_string(scene.polygons) +
                          " triangles, because a position is not finite or beyond 1e30.");
  }
  const std::uint64_t degenerate = count_degenerate(scene);
  if (degenerate > 0) {
    scene.notes.push_back(std::to_string(degenerate) + " of " + std::to_string(scene.triangles.size()) +
                          " triangles have no area; no ray can hit them.");
  }
}

/// What the exporter keeps beside the glTF model: background and ambient light.
void read_own_surroundings(const Model& model, Scene& scene) {
  if (const tinygltf::Value* own = gltf::own_extras(model.data().extras)) {
    scene.background = gltf::color_in(*own, "background", 0.0, 1e9).value_or(scene.background);
    scene.ambient = gltf::color_in(*own, "ambient", 0.0, 1e9).value_or(scene.ambient);
  }
}

Scene build(const Model& model, const ImageDecoder& decode) {
  check_requirements(model);
  Scene scene;
  scene.name = model.path().filename().string();
  const std::vector<gltf::PlacedNode> nodes = gltf::place_nodes(model);
  LeftOut left_out;
  gltf::Materials materials(model, decode, scene, left_out);
  gltf::MeshReader meshes(model, materials, scene, left_out);
  for (const gltf::PlacedNode& place : nodes) {
    const tinygltf::Node& node = model.data().nodes[static_cast<std::size_t>(place.node)];
    if (node.mesh >= 0) {
      left_out.features["skins (their meshes are in the bind pose)"] += node.skin >= 0 ? 1U : 0U;
      meshes.add(node.mesh, place);
    }
  }
  if (scene.triangles.empty()) {
    model.fail(meshes.bad_triangles() > 0 ? "none of its triangles has finite positions"
                                          : "the scene has no triangles");
  }
  if (!scene.normals.empty()) {
    scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
  }
  if (!scene.uvs.empty()) {
    scene.uvs.resize(scene.positions.size(), glm::dvec2(0.0));
  }
  if (!gltf::set_camera(model, nodes, scene)) {
    gltf::frame_camera(scene);
    scene.notes.emplace_back("The scene has no perspective camera; it is seen by one that frames it.");
  }
  gltf::add_lights(model, nodes, scene);
  read_own_surroundings(model, scene);
  if (scene.lights.empty()) {
    gltf::add_default_light(scene);
    scene.notes.emplace_back(
        "The scene has no light; it is lit by a directional one over the camera's shoulder and by ambient "
        "light.");
  }
  note_left_out(model, left_out, meshes.bad_triangles(), scene);
  return scene;
}

}  // namespace

Scene load_gltf(const std::filesystem::path& path, const GltfOptions& options, const ImageDecoder& decode) {
  const Model model(path, options);
  try {
    return build(model, decode);
  } catch (const std::bad_alloc&) {
    model.fail("there is not enough memory for its scene");
  }
}

}  // namespace marti::scenes
