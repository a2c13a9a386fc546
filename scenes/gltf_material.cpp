#include "scenes/gltf_material.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "scenes/image_file.h"
#include "scenes/surface_weights.h"
#include "sim/shown.h"

namespace marti::scenes::gltf {

namespace {

constexpr const char* no_image = "textures that are missing or cannot be decoded, by none";

const tinygltf::Value* extension(const tinygltf::ExtensionMap& map, const char* name) {
  const auto found = map.find(name);
  return found == map.end() ? nullptr : &found->second;
}

/// The image of a texture; if it has none that all programs can read, that of EXT_texture_webp.
int image_of(const tinygltf::Texture& texture) {
  const tinygltf::Value* const webp = extension(texture.extensions, "EXT_texture_webp");
  return texture.source < 0 && webp != nullptr ? index_in(*webp, "source").value_or(-1) : texture.source;
}

bool in_range(const std::optional<double>& value, double lowest, double highest) {
  return value && *value >= lowest && *value <= highest;
}

/// Replaces the weights by the exact ones, if all of these exist and are in range.
bool apply_own_weights(const tinygltf::Value& own, Material& material) {
  const auto color = color_in(own, "color", 0.0, 1.0);
  const auto specular = color_in(own, "specular_color", 0.0, 1.0);
  const auto emission = color_in(own, "emission", 0.0, largest_emission);
  const auto diffuse = number_in(own, "diffuse");
  const auto reflection = number_in(own, "reflection");
  const auto transmission = number_in(own, "transmission");
  const auto highlight = number_in(own, "highlight");
  const auto ior = number_in(own, "ior");
  const auto shininess = number_in(own, "shininess");
  if (!color || !specular || !emission || !in_range(diffuse, 0.0, 1.0) || !in_range(reflection, 0.0, 1.0) ||
      !in_range(transmission, 0.0, 1.0) || !in_range(highlight, 0.0, 1.0) ||
      !in_range(ior, 1.0, largest_ior) || !in_range(shininess, 0.0, 1e9)) {
    return false;
  }
  material.color = *color;
  material.specular_color = *specular;
  material.emission = *emission;
  material.diffuse = *diffuse;
  material.reflection = *reflection;
  material.transmission = *transmission;
  material.highlight = *highlight;
  material.ior = *ior;
  material.shininess = *shininess;
  return true;
}

}  // namespace

std::optional<double> number_in(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) {
    return std::nullopt;
  }
  const double value = object.Get(key).GetNumberAsDouble();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<int> index_in(const tinygltf::Value& object, const char* key) {
  const double index = number_in(object, key).value_or(-1.0);
  return index >= 0.0 && index < 1e9 && index == std::floor(index) ? std::optional(static_cast<int>(index))
                                                                   : std::nullopt;
}

std::optional<glm::dvec3> color_in(const tinygltf::Value& object, const char* key, double lowest,
                                   double highest) {
  if (!object.IsObject() || !object.Has(key) || object.Get(key).ArrayLen() != 3) {
    return std::nullopt;
  }
  glm::dvec3 color;
  for (int i = 0; i < 3; ++i) {
    const tinygltf::Value& channel = object.Get(key).Get(i);
    if (!channel.IsNumber() ||
        !(channel.GetNumberAsDouble() >= lowest && channel.GetNumberAsDouble() <= highest)) {
      return std::nullopt;
    }
    color[i] = channel.GetNumberAsDouble();
  }
  return color;
}

const tinygltf::Value* own_extras(const tinygltf::Value& extras) {
  return extras.IsObject() && extras.Has("marti") ? &extras.Get("marti") : nullptr;
}

Materials::Use Materials::use(int index) {
  const auto known = used_.find(index);
  if (known != used_.end()) {
    return known->second;
  }
  Use use;
  Material material = convert(index, use);
  use.material = static_cast<std::uint32_t>(scene_.materials.size());
  scene_.materials.push_back(std::move(material));
  used_.emplace(index, use);
  return use;
}

/// KHR_texture_transform: scaled, then turned counter-clockwise as seen, then moved.
TextureTransform Materials::transform_of(const tinygltf::Value& given, const std::string& user) const {
  const auto pair = [&](const char* key, double otherwise) {
    if (!given.IsObject() || !given.Has(key)) {
      return glm::dvec2(otherwise);
    }
    const tinygltf::Value& list = given.Get(key);
    glm::dvec2 values;
    for (int i = 0; i < 2; ++i) {
      const bool number = list.ArrayLen() == 2 && list.Get(i).IsNumber();
      values[i] = checked_number(model_, number ? list.Get(i).GetNumberAsDouble() : std::nan(""), -1e9, 1e9,
                                 user + ": a number of its texture's transform");
    }
    return values;
  };
  const double turn = checked_number(model_, number_in(given, "rotation").value_or(0.0), -1e9, 1e9,
                                     user + ": its texture's rotation");
  const glm::dvec2 scale = pair("scale", 1.0);
  const glm::dvec2 offset = pair("offset", 0.0);
  return {{scale.x * std::cos(turn), -scale.x * std::sin(turn), scale.y * std::sin(turn),
           scale.y * std::cos(turn), offset.x, offset.y}};
}

Material Materials::convert(int index, Use& use) {
  const std::string name = index < 0 ? "the default material" : "material " + std::to_string(index);
  const tinygltf::Material fallback;
  const tinygltf::Material& source =
      index < 0 ? fallback : model_.at(model_.data().materials, index, "material", "a primitive");
  const auto unit = [&](double value, const char* what) {
    return checked_number(model_, value, 0.0, 1.0, name + ": " + what);
  };
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  if (pbr.baseColorFactor.size() != 4 ||
      (!source.emissiveFactor.empty() && source.emissiveFactor.size() != 3)) {
    model_.fail(name + ": a base colour has 4 numbers and an emissive factor 3");
  }
  Material material;
  material.name = source.name;
  for (int i = 0; i < 3; ++i) {
    material.color[i] = unit(pbr.baseColorFactor[static_cast<std::size_t>(i)], "the base colour");
  }
  material.ior = 1.5;
  if (const tinygltf::Value* ior = extension(source.extensions, "KHR_materials_ior")) {
    // In the extension 0 means an infinite index: total reflection.
    const double given = number_in(*ior, "ior").value_or(1.5);
    material.ior = given == 0.0
                       ? largest_ior
                       : checked_number(model_, given, 1.0, largest_ior, name + ": the index of refraction");
  }
  double transmission = 0.0;
  if (const tinygltf::Value* t = extension(source.extensions, "KHR_materials_transmission")) {
    transmission = unit(number_in(*t, "transmissionFactor").value_or(0.0), "the transmission");
    left_out_.features["transmission textures"] += t->Has("transmissionTexture") ? 1U : 0U;
  }
  double strength = 1.0;
  if (const tinygltf::Value* e = extension(source.extensions, "KHR_materials_emissive_strength")) {
    strength = checked_number(model_, number_in(*e, "emissiveStrength").value_or(1.0), 0.0, largest_emission,
                              name + ": the emissive strength");
  }
  for (std::size_t i = 0; i < source.emissiveFactor.size(); ++i) {
    material.emission[static_cast<int>(i)] = std::min(
        largest_emission, strength * checked_number(model_, source.emissiveFactor[i], 0.0, largest_emission,
                                                    name + ": the emissive factor"));
  }
  set_surface_weights(material, unit(pbr.metallicFactor, "the metallic factor"),
                      unit(pbr.roughnessFactor, "the roughness factor"), transmission);
  if (const tinygltf::Value* own = own_extras(source.extras);
      own != nullptr && !apply_own_weights(*own, material)) {
    left_out_.features["materials' own weights (extras.marti) that are incomplete or out of range"] += 1;
  }
  left_out_.features["textures other than the base colour"] +=
      static_cast<std::uint64_t>(pbr.metallicRoughnessTexture.index >= 0) +
      static_cast<std::uint64_t>(source.normalTexture.index >= 0) +
      static_cast<std::uint64_t>(source.occlusionTexture.index >= 0) +
      static_cast<std::uint64_t>(source.emissiveTexture.index >= 0);
  if (pbr.baseColorTexture.index >= 0) {
    material.texture = texture_index(pbr.baseColorTexture.index, name);
    use.texture_coordinates = pbr.baseColorTexture.texCoord;
    if (const tinygltf::Value* given = extension(pbr.baseColorTexture.extensions, "KHR_texture_transform")) {
      use.transform = transform_of(*given, name);
      use.texture_coordinates =
          given->Has("texCoord") ? index_in(*given, "texCoord").value_or(-1) : use.texture_coordinates;
    }
    if (use.texture_coordinates < 0 || use.texture_coordinates > 63) {
      model_.fail(name + ": there is no set of texture coordinates " +
                  std::to_string(use.texture_coordinates));
    }
    use.texture_coordinates = material.texture == no_texture ? -1 : use.texture_coordinates;
  }
  material.cut_out = cut_out_of(source, material.texture, name);
  return material;
}

CutOut Materials::cut_out_of(const tinygltf::Material& source, std::uint32_t texture,
                             const std::string& name) const {
  const bool blends = source.alphaMode == "BLEND";
  if (!blends && source.alphaMode != "MASK") {
    if (source.alphaMode != "OPAQUE") {
      left_out_.replace("alpha modes that glTF does not have, by OPAQUE",
                        sim::shown(model_.path().string()) + ": " + name + ": there is no alpha mode '" +
                            sim::shown(source.alphaMode) + "'");
    }
    return {};
  }
  left_out_.features["materials' blending (alphaMode BLEND; cut out where alpha is below 0.5)"] +=
      blends ? 1U : 0U;
  CutOut cut_out;
  cut_out.alpha = checked_number(model_, source.pbrMetallicRoughness.baseColorFactor[3], 0.0, 1.0,
                                 name + ": the alpha of the base colour");
  cut_out.cutoff = blends
                       ? cutoff_of_blending
                       : checked_number(model_, source.alphaCutoff, 0.0, 1e9, name + ": the alpha cut-off");
  cut_out.texture = texture;
  return cut_out;
}

std::uint32_t Materials::texture_index(int texture, const std::string& user) {
  const tinygltf::Texture& source = model_.at(model_.data().textures, texture, "texture", user);
  const std::string name = "texture " + std::to_string(texture);
  tinygltf::Sampler sampler;
  if (source.sampler >= 0) {
    sampler = model_.at(model_.data().samplers, source.sampler, "sampler", name);
  }
  for (const int wrap : {sampler.wrapS, sampler.wrapT}) {
    if (wrap != TINYGLTF_TEXTURE_WRAP_REPEAT && wrap != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE &&
        wrap != TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) {
      left_out_.replace("wrap modes of textures that glTF does not have, by repeating",
                        sim::shown(model_.path().string()) + ": sampler " + std::to_string(source.sampler) +
                            ": there is no wrap mode " + std::to_string(wrap));
    }
  }
  const int from = image_of(source);
  if (from < 0) {
    left_out_.replace(no_image, sim::shown(model_.path().string()) + ": " + name + " refers to image " +
                                    std::to_string(from) + ", but the file has " +
                                    std::to_string(model_.data().images.size()));
    return no_texture;
  }
  const int image = first_alike(from, name);
  const auto key = std::tuple(image, sampler.wrapS, sampler.wrapT);
  images_.insert(from);
  const auto [place, is_new] = textures_.try_emplace(key, no_texture);
  if (!is_new) {
    return place->second;
  }
  Texture decoded;
  try {
    decoded = open_image(model_, find_image(image, name), decode_, left_out_);
  } catch (const ImageError& error) {
    left_out_.replace(no_image, error.what());
    return no_texture;
  }
  decoded.srgb = true;
  decoded.repeat_u = sampler.wrapS != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  decoded.repeat_v = sampler.wrapT != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  left_out_.features["mirrored texture repeats (repeated without mirroring)"] +=
      sampler.wrapS == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ||
              sampler.wrapT == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT
          ? 1U
          : 0U;
  place->second = static_cast<std::uint32_t>(scene_.textures.size());
  scene_.textures.push_back(std::move(decoded));
  return place->second;
}

int Materials::first_alike(int image, const std::string& user) {
  const std::span<const std::byte> bytes = find_image(image, user).bytes;
  const auto [place, is_new] = image_at_.try_emplace(std::pair(bytes.data(), bytes.size()), image);
  if (is_new) {
    // Images that overlap each other in a buffer can have many times its bytes.
    compared_ += bytes.size();
    if (compared_ / 8 > model_.options().max_file_bytes) {
      model_.fail("its images together have more than 8 times the bytes that a file may have");
    }
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    place->second = image_of_bytes_.try_emplace(text, image).first->second;
  }
  return place->second;
}

void Materials::check_image(int image) const {
  try {
    static_cast<void>(decode_image(model_, find_image(image, "the file"), decode_));
  } catch (const ImageError& error) {
    left_out_.replace(no_image, error.what());
  }
}

ImageFile Materials::find_image(int image, const std::string& user) const {
  const tinygltf::Image& source = model_.at(model_.data().images, image, "image", user);
  ImageFile found;
  found.name = !source.name.empty()  ? source.name
               : !source.uri.empty() ? source.uri
                                     : "image " + std::to_string(image);
  found.bytes = std::as_bytes(std::span(source.image));
  if (source.bufferView >= 0) {
    found.bytes = model_.view_bytes(source.bufferView, "image " + std::to_string(image));
  }
  return found;
}

}  // namespace marti::scenes::gltf
