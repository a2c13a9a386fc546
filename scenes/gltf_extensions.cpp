#include "scenes/gltf_extensions.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "scenes/gltf_draco.h"
#include "scenes/gltf_meshopt.h"
#include "sim/shown.h"

namespace marti::scenes::gltf {

namespace {

constexpr std::array<std::string_view, 8> supported_extensions = {
    "EXT_mesh_gpu_instancing",         "EXT_texture_webp",     "KHR_lights_punctual",
    "KHR_materials_emissive_strength", "KHR_materials_ior",    "KHR_materials_transmission",
    "KHR_mesh_quantization",           "KHR_texture_transform"};
/// Extensions that change no geometry: without them a file looks otherwise, and no more.
constexpr std::array<std::string_view, 14> appearances = {"KHR_materials_anisotropy",
                                                          "KHR_materials_clearcoat",
                                                          "KHR_materials_diffuse_transmission",
                                                          "KHR_materials_dispersion",
                                                          "KHR_materials_iridescence",
                                                          "KHR_materials_pbrSpecularGlossiness",
                                                          "KHR_materials_sheen",
                                                          "KHR_materials_specular",
                                                          "KHR_materials_unlit",
                                                          "KHR_materials_variants",
                                                          "KHR_materials_volume",
                                                          "KHR_texture_basisu",
                                                          "KHR_xmp",
                                                          "KHR_xmp_json_ld"};
constexpr const char* draco = "KHR_draco_mesh_compression";

bool is_meshopt(const std::string& extension) {
  return std::find(meshopt_names.begin(), meshopt_names.end(), extension) != meshopt_names.end();
}

bool is_supported(const std::string& extension) {
  return (extension == draco && has_draco()) || (is_meshopt(extension) && has_meshopt()) ||
         std::find(supported_extensions.begin(), supported_extensions.end(), extension) !=
             supported_extensions.end();
}

bool has_no_bytes(const tinygltf::Model& file, int accessor) {
  return accessor >= 0 && static_cast<std::size_t>(accessor) < file.accessors.size() &&
         file.accessors[static_cast<std::size_t>(accessor)].bufferView < 0;
}

}  // namespace

std::string meshopt_among(const tinygltf::ExtensionMap& extensions) {
  for (const char* name : meshopt_names) {
    if (extensions.contains(name)) {
      return name;
    }
  }
  return {};
}

bool is_compression(const std::string& extension) { return extension == draco || is_meshopt(extension); }

std::string why_unsupported(const std::string& extension) {
  if (extension == draco && !has_draco()) {
    return "for which marti was built without the library Draco (Debian's libdraco-dev)";
  }
  if (is_meshopt(extension) && !has_meshopt()) {
    return "for which marti was built without the library meshoptimizer (Debian's libmeshoptimizer-dev)";
  }
  return "which is not supported";
}

std::vector<std::string> missing_requirements(const tinygltf::Model& file) {
  std::vector<std::string> missing;
  std::copy_if(file.extensionsRequired.begin(), file.extensionsRequired.end(), std::back_inserter(missing),
               [](const std::string& extension) { return !is_supported(extension); });
  return missing;
}

bool is_appearance(const std::string& extension) {
  return std::find(appearances.begin(), appearances.end(), extension) != appearances.end();
}

std::string ignored_extensions(const tinygltf::Model& file) {
  std::string names;
  for (const std::string& extension : file.extensionsUsed) {
    const auto& required = file.extensionsRequired;
    if (!is_supported(extension) &&
        std::find(required.begin(), required.end(), extension) == required.end()) {
      names += (names.empty() ? "" : ", ") + sim::shown(extension);
    }
  }
  return names;
}

std::string compression_of_view(const tinygltf::Model& file, int view) {
  const tinygltf::BufferView& compressed = file.bufferViews[static_cast<std::size_t>(view)];
  const tinygltf::Buffer& buffer = file.buffers[static_cast<std::size_t>(compressed.buffer)];
  // The bytes of a buffer with the extension exist only after decompression, unless the buffer has a URI. For
  // a buffer without one in a .glb file, tinygltf substitutes the bytes of the file itself.
  return buffer.uri.empty() && !meshopt_among(buffer.extensions).empty() ? meshopt_among(buffer.extensions)
                                                                         : std::string();
}

std::string compression_of_primitive(const tinygltf::Model& file, const tinygltf::Primitive& primitive) {
  const bool compressed =
      primitive.extensions.contains(draco) &&
      (has_no_bytes(file, primitive.indices) ||
       std::any_of(primitive.attributes.begin(), primitive.attributes.end(),
                   [&](const auto& attribute) { return has_no_bytes(file, attribute.second); }));
  return compressed ? draco : std::string();
}

}  // namespace marti::scenes::gltf
