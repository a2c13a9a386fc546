#include "scenes/pbrt_material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <glm/common.hpp>

#include "scenes/image_file.h"
#include "scenes/pbrt_color.h"
#include "scenes/surface_weights.h"
#include "scenes/text_lines.h"

namespace marti::scenes::pbrt {

namespace {

// Textures that refer to two others, and materials that are mixed of others.
constexpr int most_nested = 8;

constexpr std::uint64_t bytes_of_entry = 256;  // of a list of names, beside the name

constexpr std::array<std::string_view, 4> matt = {"diffuse", "matte", "diffusetransmission", "translucent"};
constexpr std::array<std::string_view, 4> coated = {"coateddiffuse", "plastic", "substrate", "uber"};
constexpr std::array<std::string_view, 4> glassy = {"dielectric", "thindielectric", "roughdielectric",
                                                    "glass"};
constexpr std::array<std::string_view, 3> metallic = {"conductor", "coatedconductor", "metal"};
constexpr std::array<std::string_view, 6> without_model = {"subsurface", "kdsubsurface", "hair",
                                                           "measured",   "disney",       "fourier"};

template <std::size_t Count>
bool is_one_of(const std::array<std::string_view, Count>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// What a diffuse colour is called in versions 4 and 3.
std::string_view name_of_diffuse(const Parameters& parameters) {
  return parameters.find("reflectance") == nullptr && parameters.find("Kd") != nullptr ? "Kd" : "reflectance";
}

}  // namespace

PbrtMaterials::PbrtMaterials(const SourceFile& file, Text& text, const ImageDecoder& decode, Scene& scene,
                             LeftOut& left_out)
    : file_(file), text_(text), decode_(decode), scene_(scene), left_out_(left_out) {
  known_.push_back({"default", "diffuse", {}, {}});
}

std::size_t PbrtMaterials::add(std::string type, Parameters parameters) {
  file_.take_memory(2 * (sizeof(Known) + 2 * type.size()) + parameters.bytes(), "its materials take");
  known_.push_back({type, std::move(type), std::move(parameters), {}});
  return known_.size() - 1;
}

void PbrtMaterials::add_named(const std::string& name, Parameters parameters) {
  const std::string type = parameters.text("type");
  file_.take_memory(bytes_of_entry + 2 * name.size(), "its materials take");
  by_name_[name] = add(type, std::move(parameters));
  known_.back().name = name;
}

std::size_t PbrtMaterials::named(const std::string& name) const {
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) {
    text_.fail("there is no material " + in_quotes(name) + " (MakeNamedMaterial) before it");
  }
  return found->second;
}

void PbrtMaterials::add_texture(std::string name, std::string kind, Parameters parameters) {
  file_.take_memory(bytes_of_entry + name.size() + kind.size() + parameters.bytes(), "its textures take");
  textures_.insert_or_assign(std::move(name), KnownTexture{std::move(kind), std::move(parameters), false});
}

CutOut PbrtMaterials::cut_out_of(const Parameters& shape) {
  const Parameter* const alpha = shape.find("alpha");
  if (alpha == nullptr) {
    return {};
  }
  const Tint tint = alpha->type == "texture"
                        ? texture(shape.text("alpha"), shape, true, 0)
                        : Tint{glm::dvec3(shape.number("alpha", 1.0, 0.0, 1.0)), no_texture};
  return {std::min(1.0, (tint.color.x + tint.color.y + tint.color.z) / 3.0), cutoff_of_blending,
          tint.texture};
}

std::optional<std::uint32_t> PbrtMaterials::in_scene(std::size_t material, const glm::dvec3& emission,
                                                     const CutOut& cut_out) {
  Known& known = known_[material];
  const std::tuple look{std::array{emission.x, emission.y, emission.z}, cut_out.alpha, cut_out.texture};
  if (const auto same = known.in_scene.find(look); same != known.in_scene.end()) {
    return same->second;
  }
  std::optional<Material> made = convert(known, 0);
  if (known.in_scene.empty()) {
    known.parameters.leave_out_rest(left_out_);
  }
  if (!made) {
    return std::nullopt;
  }
  file_.take_memory(2 * (sizeof(Material) + known.name.size()), "its materials take");
  made->name = known.name;
  made->emission = emission;
  made->cut_out = cut_out;
  used_ += known.in_scene.empty() ? 1U : 0U;
  const auto place = static_cast<std::uint32_t>(scene_.materials.size());
  scene_.materials.push_back(*std::move(made));
  known.in_scene.emplace(look, place);
  return place;
}

std::optional<Material> PbrtMaterials::convert(const Known& known, int depth) {
  const Parameters& parameters = known.parameters;
  const auto refused = [&](const std::string& what) { return parameters.place() + ": " + what; };
  if (known.type.empty() || known.type == "interface" || known.type == "none") {
    return std::nullopt;
  }
  left_out_.features["displacements of materials"] += parameters.find("displacement") != nullptr ? 1U : 0U;
  left_out_.features["normal maps of materials"] += parameters.find("normalmap") != nullptr ? 1U : 0U;
  Material material;
  if (is_one_of(matt, known.type)) {
    left_out_.features["light that diffuse materials let through"] +=
        parameters.find("transmittance") != nullptr ? 1U : 0U;
    const glm::dvec3 grey(known.type == "diffusetransmission" ? 0.25 : 0.5);
    const Tint tinted = tint(parameters, name_of_diffuse(parameters), grey, false);
    material.color = tinted.color;
    material.texture = tinted.texture;
  } else if (is_one_of(coated, known.type)) {
    const Tint tinted = tint(parameters, name_of_diffuse(parameters), glm::dvec3(0.5), false);
    material.color = tinted.color;
    material.texture = tinted.texture;
    material.ior = index_of_refraction(parameters, left_out_);
    set_surface_weights(material, 0.0, roughness(parameters, 0.0), 0.0);
  } else if (is_one_of(glassy, known.type)) {
    material.color = glm::dvec3(1.0);
    material.ior = index_of_refraction(parameters, left_out_);
    set_surface_weights(material, 0.0, roughness(parameters, 0.0), 1.0);
    material.ior = known.type == "thindielectric" ? 1.0 : material.ior;
  } else if (is_one_of(metallic, known.type)) {
    material.color = metal_color(parameters, left_out_);
    set_surface_weights(material, 1.0, roughness(parameters, known.type == "metal" ? 0.01 : 0.0), 0.0);
  } else if (known.type == "mirror") {
    material.color = color_in(parameters, "Kr", glm::dvec3(0.9), 1.0, left_out_);
    set_surface_weights(material, 1.0, 0.0, 0.0);
  } else if (known.type == "mix") {
    const Parameter* const both = parameters.find("materials");
    if (both == nullptr || both->texts.size() != 2 || depth == most_nested) {
      parameters.fail("a mix needs the parameter 'materials' with two names, and no more than " +
                      std::to_string(most_nested) + " mixed of others");
    }
    const Parameter* const amount = parameters.find("amount");
    const bool second =
        amount != nullptr && amount->type != "texture" && parameters.number("amount", 0.5, 0.0, 1.0) > 0.5;
    left_out_.replace("mixed materials, by the one that is more",
                      refused("mixed materials are not supported"));
    return convert(known_[named(both->texts[second ? 1 : 0])], depth + 1);
  } else if (is_one_of(without_model, known.type)) {
    left_out_.replace("materials " + known.type + ", by matt grey",
                      refused("materials " + known.type + " are not supported"));
    material.color = glm::dvec3(0.5);
  } else {
    parameters.fail("there is no type of material " + in_quotes(known.type));
  }
  return material;
}

double PbrtMaterials::roughness(const Parameters& parameters, double otherwise) {
  const auto one = [&](std::string_view name, double other) {
    const Parameter* const found = parameters.find(name);
    if (found != nullptr && found->type == "texture") {
      left_out_.features["textures of roughness"] += 1;
      return other;
    }
    return parameters.number(name, other, 0.0, 1e3);
  };
  const double both = one("roughness", otherwise);
  const double mean = std::min(1.0, 0.5 * (one("uroughness", both) + one("vroughness", both)));
  return parameters.text("remaproughness") == "false" ? std::sqrt(mean) : std::sqrt(std::sqrt(mean));
}

PbrtMaterials::Tint PbrtMaterials::tint(const Parameters& parameters, std::string_view name,
                                        const glm::dvec3& otherwise, bool is_alpha, int depth) {
  const Parameter* const found = parameters.find(name);
  if (found != nullptr && found->type == "texture") {
    return texture(parameters.text(name), parameters, is_alpha, depth);
  }
  return {color_in(parameters, name, otherwise, 1.0, left_out_), no_texture};
}

PbrtMaterials::Tint PbrtMaterials::texture(const std::string& name, const Parameters& by, bool is_alpha,
                                           int depth) {
  const auto found = textures_.find(name);
  if (found == textures_.end() || depth == most_nested) {
    by.fail(found == textures_.end()
                ? "there is no texture " + in_quotes(name) + " before it"
                : "more than " + std::to_string(most_nested) + " textures refer to each other");
  }
  found->second.used = true;
  const std::string& kind = found->second.kind;
  const Parameters& parameters = found->second.parameters;
  if (kind == "constant") {
    return tint(parameters, "value", glm::dvec3(1.0), is_alpha, depth + 1);
  }
  if (kind == "scale") {
    Tint scaled = tint(parameters, "tex", glm::dvec3(1.0), is_alpha, depth + 1);
    const Tint by_what = tint(parameters, "scale", glm::dvec3(1.0), is_alpha, depth + 1);
    scaled.color *= by_what.color;
    scaled.texture = scaled.texture == no_texture ? by_what.texture : scaled.texture;
    return scaled;
  }
  if (kind == "imagemap") {
    const double scale = std::min(1.0, parameters.number("scale", 1.0, 0.0, 1e9));
    for (const char* const coordinate : {"uscale", "vscale", "udelta", "vdelta", "mapping", "invert"}) {
      left_out_.features["coordinates of textures that are scaled or mapped, or values that are inverted"] +=
          parameters.find(coordinate) != nullptr ? 1U : 0U;
    }
    return {glm::dvec3(scale), image(parameters, is_alpha)};
  }
  left_out_.replace("textures that are no images, by grey",
                    parameters.place() + ": textures of the kind " + in_quotes(kind) + " are not supported");
  return {glm::dvec3(0.5), no_texture};
}

void PbrtMaterials::leave_out_rest() const {
  for (const auto& [name, texture] : textures_) {
    if (texture.used) {
      texture.parameters.leave_out_rest(left_out_);
    }
  }
}

std::uint32_t PbrtMaterials::image(const Parameters& parameters, bool is_alpha) {
  const std::string name = parameters.text("filename");
  const bool clamp = !parameters.text("wrap").empty() && parameters.text("wrap") != "repeat";
  const bool linear = parameters.text("encoding") == "linear";
  const auto [place, is_new] = images_.try_emplace({name, clamp, linear, is_alpha}, no_texture);
  if (!is_new) {
    return place->second;
  }
  std::string reason;
  const std::optional<std::string> bytes = text_.read(name, reason);
  if (!bytes) {
    left_out_.replace("textures that cannot be read, by none", reason);
    return no_texture;
  }
  place->second =
      add_image(file_, {name, std::as_bytes(std::span(*bytes))}, decode_, clamp, scene_, left_out_);
  if (place->second != no_texture) {
    scene_.textures[place->second].srgb = !linear;
    scene_.textures[place->second].grey_is_alpha = is_alpha;
  }
  return place->second;
}

}  // namespace marti::scenes::pbrt
