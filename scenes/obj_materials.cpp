#include "scenes/obj_materials.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "scenes/image_file.h"
#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

double largest_of(const glm::dvec3& color) { return std::max({color.x, color.y, color.z}); }

/// The folder of a file, with a slash at the end; empty for a file in the folder itself.
std::string folder_of(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? std::string() : name.substr(0, slash + 1);
}

}  // namespace

ObjMaterials::ObjMaterials(const SourceFile& file, const ImageDecoder& decode, Scene& scene,
                           LeftOut& left_out)
    : file_(file),
      decode_(decode),
      scene_(scene),
      left_out_(left_out),
      access_(file.path().parent_path(), file.options().max_file_bytes, file.memory(), "file name") {}

std::optional<std::string> ObjMaterials::bytes_of(const std::string& path, const std::string& place,
                                                  std::string& reason) {
  const std::string name = access_.directory() + path;
  std::string bytes;
  std::string error = "there is no such file";
  const bool exists = access_.may_read(name);
  if (exists) {
    error.clear();
  }
  if (exists && access_.read(name, bytes, error)) {
    return bytes;
  }
  if (!access_.refusal().empty()) {
    throw sim::UserError(place + ": " + access_.refusal());
  }
  reason = place + ": " + in_quotes(path) + " cannot be read: " + error;
  return std::nullopt;
}

void ObjMaterials::add_libraries(const TextLines& statement) {
  std::string whole(statement.from(1));
  std::replace(whole.begin(), whole.end(), '\\', '/');
  if (whole.empty()) {
    left_out_.replace("statements mtllib without a file's name, by no library",
                      statement.refusal("mtllib needs the name of a file"));
    return;
  }
  // One name with blanks, or several names: a text longer than any file's name can only be the latter.
  constexpr std::size_t longest_name = 255;
  if (statement.words().size() == 2 ||
      (whole.size() <= longest_name && access_.may_read(access_.directory() + whole))) {
    add_library(whole, statement);
    return;
  }
  for (std::size_t i = 1; i < statement.words().size(); ++i) {
    std::string name(statement.words()[i]);
    std::replace(name.begin(), name.end(), '\\', '/');
    add_library(name, statement);
  }
}

void ObjMaterials::add_library(const std::string& name, const TextLines& statement) {
  if (!libraries_.insert(std::filesystem::path(name).lexically_normal().string()).second) {
    return;
  }
  std::string reason;
  std::optional<std::string> bytes = bytes_of(name, statement.place(), reason);
  if (!bytes) {
    left_out_.replace("material libraries that cannot be read, by none", reason);
    return;
  }
  file_.require_memory(2 * bytes->size(), "its materials take");
  const std::string text = in_utf8(*std::move(bytes));
  std::uint64_t most = 0;  // of its materials
  for (std::size_t at = text.find("newmtl"); at != std::string::npos; at = text.find("newmtl", at + 1)) {
    ++most;
  }
  // In both lists, with its places in the text and in the index of names.
  file_.take_memory(most * (2 * sizeof(Known) + 512), "its materials take");
  for (MtlMaterial& material : read_mtl(text, sim::shown(access_.directory() + name), left_out_)) {
    const auto [known, is_new] = by_name_.try_emplace(material.name, known_.size());
    if (!is_new) {
      left_out_.replace("further definitions of a material's name, by the first",
                        material.place + ": the material " + in_quotes(material.name) +
                            " is defined a second time; the first is at " +
                            known_[known->second].source.place);
      continue;
    }
    known_.push_back({std::move(material), folder_of(name), std::nullopt});
  }
}

void ObjMaterials::choose(const TextLines& statement) {
  const auto found = by_name_.find(statement.from(1));
  chosen_ = found == by_name_.end() ? std::nullopt : std::optional(found->second);
  if (!chosen_) {
    left_out_.replace("statements usemtl of a material that no library has, by matt grey",
                      statement.refusal("there is no material " + in_quotes(statement.from(1)) +
                                        " in the libraries (mtllib) named before it"));
  }
}

std::uint32_t ObjMaterials::current() {
  std::optional<std::uint32_t>& place = chosen_ ? known_[*chosen_].in_scene : default_material_;
  if (!place) {
    const Material material = chosen_ ? convert(known_[*chosen_]) : Material{};
    used_ += chosen_ ? 1U : 0U;
    place = static_cast<std::uint32_t>(scene_.materials.size());
    scene_.materials.push_back(material);
  }
  return *place;
}

Material ObjMaterials::convert(const Known& known) {
  const MtlMaterial& source = known.source;
  const std::int64_t model = source.illumination;
  const bool refracts = model == 4 || model == 6 || model == 7 || model == 9;
  const double specular = largest_of(source.specular);
  Material material;
  material.name = source.name;
  material.color = source.diffuse;
  material.emission = source.emission;
  material.highlight = model >= 2 ? specular : 0.0;
  material.reflection = model >= 3 && model <= 9 ? specular : 0.0;
  material.specular_color = specular > 0.0 ? source.specular / specular : glm::dvec3(1.0);
  material.shininess = std::max(1.0, source.exponent);
  const double opacity = source.opacity.value_or(1.0 - source.transparency.value_or(0.0));
  if (source.opacity && source.transparency &&
      std::abs(*source.opacity + *source.transparency - 1.0) > 1e-3) {
    left_out_.features["transparencies Tr that contradict d"] += 1;
  }
  material.cut_out = cut_out_of(known, opacity);
  // Where a map says what is cut out, all else is opaque.
  material.diffuse = material.cut_out.asks() ? 1.0 : opacity;
  material.transmission = 1.0 - material.diffuse;
  if (source.filter && (model == 6 || model == 7)) {
    material.transmission = std::max(material.transmission, (1.0 - specular) * largest_of(*source.filter));
  }
  if (refracts && material.transmission > 0.0) {
    left_out_.features["indices of refraction below 1"] += source.ior < 1.0 ? 1U : 0U;
    material.ior = std::max(1.0, source.ior);
  }
  if (!source.texture.file.empty()) {
    material.texture = texture_of(known, source.texture, false);
  }
  return material;
}

CutOut ObjMaterials::cut_out_of(const Known& known, double opacity) {
  const MtlMap& map = known.source.opacity_map;
  if (map.file.empty()) {
    return {};
  }
  // The image of colours is named once more for its alpha.
  const bool same = map.file == known.source.texture.file;
  return {opacity, cutoff_of_blending, texture_of(known, map, !map.matte && !same)};
}

std::uint32_t ObjMaterials::texture_of(const Known& known, const MtlMap& map, bool grey_is_alpha) {
  const std::string path = known.folder + map.file;
  const auto [place, is_new] = textures_.try_emplace({path, map.clamp, grey_is_alpha}, no_texture);
  if (!is_new) {
    return place->second;
  }
  std::string reason;
  const std::optional<std::string> bytes = bytes_of(path, map.place, reason);
  if (!bytes) {
    left_out_.replace("textures that cannot be read, by none", reason);
    return no_texture;
  }
  place->second =
      add_image(file_, {map.file, std::as_bytes(std::span(*bytes))}, decode_, map.clamp, scene_, left_out_);
  if (place->second != no_texture) {
    scene_.textures[place->second].grey_is_alpha = grey_is_alpha;
  }
  return place->second;
}

void ObjMaterials::check_unused() {
  for (const Known& known : known_) {
    for (const MtlMap* map : {&known.source.texture, &known.source.opacity_map}) {
      if (!known.in_scene && !map->file.empty()) {
        check_image(known.folder, *map);
      }
    }
  }
}

void ObjMaterials::check_image(const std::string& folder, const MtlMap& map) {
  std::string reason;
  const std::optional<std::string> bytes = bytes_of(folder + map.file, map.place, reason);
  if (!bytes) {
    left_out_.replace("textures that cannot be read, by none", reason);
    return;
  }
  try {
    static_cast<void>(decode_image(file_, {map.file, std::as_bytes(std::span(*bytes))}, decode_));
  } catch (const ImageError& error) {
    left_out_.replace("textures that cannot be decoded, by none", error.what());
  }
}

}  // namespace marti::scenes
